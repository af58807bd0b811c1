#include "saltus/kernel/first_order/coupled_equations.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

namespace saltus {
namespace {

// Of central differences: a third of the digits, so that the error of each is its square.
const double difference_step = std::cbrt(std::numeric_limits<double>::epsilon());

// (rows, arguments) derivative of a function(out) of what is in `argument`
template <class Function>
void differentiate(Function function, double* argument, int arguments, Out value, Out moved, OutMatrix J) {
  for (int j = 0; j < arguments; ++j) {
    const double at = argument[j];
    const double step = difference_step * std::max(1.0, std::abs(at));
    argument[j] = at + step;
    value.setZero();
    function(value);
    argument[j] = at - step;
    moved.setZero();
    function(moved);
    argument[j] = at;
    J.col(j) = (value - moved) / (2.0 * step);
  }
}

}  // namespace

CoupledEquations::CoupledEquations(const FirstOrderSystem& model) : model_(model) {
  int n = 0, largest = 0, row = 0;
  for (const auto& system : model_.systems()) {
    systems_.push_back({n, system->dimension()});
    n += system->dimension();
    largest = std::max(largest, system->dimension());
    time_invariant_ = time_invariant_ && system->time_invariant();
  }
  M_ = Matrix::Identity(n, n);
  for (std::size_t k = 0; k < systems_.size(); ++k)
    if (const auto& M = model_.systems()[k]->M())
      M_.block(systems_[k].offset, systems_[k].offset, systems_[k].n, systems_[k].n) = *M;
  laws_.lower.resize(model_.rows());
  laws_.upper.resize(model_.rows());
  for (const FirstOrderSystem::Link& link : model_.links()) {
    const Part second = link.second < 0 ? Part{0, 0} : systems_[link.second];
    const int rows = link.relation->size();
    slots_.push_back({link.relation.get(), row, rows, {systems_[link.first], second}});
    laws_.lower.segment(row, rows) = link.laws.lower;
    laws_.upper.segment(row, rows) = link.laws.upper;
    row += rows;
    largest = std::max({largest, rows, slots_.back().n()});
    time_invariant_ = time_invariant_ && link.relation->time_invariant();
  }
  for (Vec* buffer : {&x_, &lambda_, &value_, &moved_}) buffer->setZero(largest);
  block_.reserve(largest, largest);
}

void CoupledEquations::hold(double time_step) {
  Matrix J = Matrix::Zero(dimension(), dimension());
  for (int k = 0; k < static_cast<int>(systems_.size()); ++k) {
    const auto [offset, n] = systems_[k];
    const std::string who = "a zero-order hold needs a system " + std::to_string(k) + " ";
    if (!model_.systems()[k]->time_invariant())
      throw std::invalid_argument(who + "that is linear with constant A, got another one");
    system_jacobian(model_.t0(), k, model_.x0(), J);
    const Matrix M = M_.block(offset, offset, n, n);
    Matrix both = Matrix::Zero(2 * n, 2 * n);  // (A, 1; 0, 0): its exponential has the integral beside exp(A)
    both.topLeftCorner(n, n) = M.partialPivLu().solve(J.block(offset, offset, n, n));
    both.topRightCorner(n, n).setIdentity();
    const Matrix exponential = (time_step * both).eval().exp();
    const Matrix integral = exponential.topRightCorner(n, n);
    const Matrix held = time_step * M * integral.inverse();
    if (!held.allFinite()) throw std::invalid_argument(who + "with a regular M and step, got a singular one");
    M_.block(offset, offset, n, n) = held;
  }
}

void CoupledEquations::f(double t, const Vec& x, Vec& f) {
  f.setZero();
  for (std::size_t k = 0; k < systems_.size(); ++k) {
    const auto [offset, n] = systems_[k];
    model_.systems()[k]->f(t, In(x.data() + offset, n), Out(f.data() + offset, n));
  }
}

void CoupledEquations::gather(const Slot& slot, const Vec& x) {
  double* to = x_.data();
  for (const Part& part : slot.parts) to = std::copy_n(x.data() + part.offset, part.n, to);
}

void CoupledEquations::output(double t, const Vec& x, const Vec& lambda, Vec& y) {
  y.setZero();
  for (const Slot& slot : slots_) {
    gather(slot, x);
    slot.relation->output(t, In(x_.data(), slot.n()), In(lambda.data() + slot.row, slot.rows),
                          Out(y.data() + slot.row, slot.rows));
  }
}

void CoupledEquations::input(double t, const Vec& x, const Vec& lambda, Vec& r) {
  r.setZero();
  for (const Slot& slot : slots_) {
    gather(slot, x);
    Out value(value_.data(), slot.n());
    value.setZero();
    slot.relation->input(t, In(x_.data(), slot.n()), In(lambda.data() + slot.row, slot.rows), value);
    int at = 0;
    for (const Part& part : slot.parts) {
      r.segment(part.offset, part.n) += value.segment(at, part.n);
      at += part.n;
    }
  }
}

CoupledEquations::Derivatives CoupledEquations::derivatives() const {
  const int n = dimension(), m = rows();
  return {Matrix::Zero(n, n), Matrix::Zero(m, n), Matrix::Zero(m, m), Matrix::Zero(n, n), Matrix::Zero(n, m)};
}

// Storage of a Jacobian, zero
OutMatrix CoupledEquations::block(int height, int width) {
  block_.resize(height, width);
  block_.view().setZero();
  return block_.view();
}

template <class Function>
void CoupledEquations::by_differences(Function function, Vec& argument, int arguments, int height) {
  differentiate(function, argument.data(), arguments, Out(value_.data(), height), Out(moved_.data(), height),
                block_.view());
}

void CoupledEquations::system_jacobian(double t, int index, const Vec& x, Matrix& all) {
  const auto [offset, n] = systems_[index];
  const FirstOrderDS& system = *model_.systems()[index];
  std::copy_n(x.data() + offset, n, x_.data());
  const In state(x_.data(), n);
  if (!system.jacobian(t, state, block(n, n)))
    by_differences([&](Out f) { system.f(t, state, f); }, x_, n, n);
  all.block(offset, offset, n, n) = block_.view();
}

// At the x_ and lambda_ of the relation, likewise the next one.
void CoupledEquations::output_jacobians(double t, const Slot& slot, Derivatives& all) {
  const FirstOrderRelation& relation = *slot.relation;
  const int n = slot.n(), rows = slot.rows;
  const In x(x_.data(), n), lambda(lambda_.data(), rows);
  const auto h = [&](Out y) { relation.output(t, x, lambda, y); };

  if (!relation.output_dlambda(t, x, lambda, block(rows, rows))) by_differences(h, lambda_, rows, rows);
  all.D.block(slot.row, slot.row, rows, rows) = block_.view();

  if (!relation.output_dx(t, x, lambda, block(rows, n))) by_differences(h, x_, n, rows);
  int at = 0;
  for (const Part& part : slot.parts) {
    all.C.block(slot.row, part.offset, rows, part.n) = block_.view().middleCols(at, part.n);
    at += part.n;
  }
}

void CoupledEquations::input_jacobians(double t, const Slot& slot, Derivatives& all) {
  const FirstOrderRelation& relation = *slot.relation;
  const int n = slot.n(), rows = slot.rows;
  const In x(x_.data(), n), lambda(lambda_.data(), rows);
  const auto g = [&](Out r) { relation.input(t, x, lambda, r); };

  if (!relation.input_dlambda(t, x, lambda, block(n, rows))) by_differences(g, lambda_, rows, n);
  int at = 0;
  for (const Part& part : slot.parts) {
    all.B.block(part.offset, slot.row, part.n, rows) = block_.view().middleRows(at, part.n);
    at += part.n;
  }

  if (!relation.input_dx(t, x, lambda, block(n, n))) by_differences(g, x_, n, n);
  int row = 0;
  for (const Part& height : slot.parts) {
    int column = 0;
    for (const Part& width : slot.parts) {
      all.K.block(height.offset, width.offset, height.n, width.n) +=
          block_.view().block(row, column, height.n, width.n);
      column += width.n;
    }
    row += height.n;
  }
}

void CoupledEquations::evaluate(double t, const Vec& x, const Vec& x_output, const Vec& lambda,
                                Derivatives& all) {
  for (int k = 0; k < static_cast<int>(systems_.size()); ++k) system_jacobian(t, k, x, all.J);
  all.K.setZero();
  for (const Slot& slot : slots_) {
    std::copy_n(lambda.data() + slot.row, slot.rows, lambda_.data());
    gather(slot, x_output);
    output_jacobians(t, slot, all);
    gather(slot, x);
    input_jacobians(t, slot, all);
  }
}

}  // namespace saltus

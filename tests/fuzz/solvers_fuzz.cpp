// Bytes become a contact problem, which every registered solver must solve, refuse or fail to solve as it
// promises. The entry is that of libFuzzer and AFL++; driver.cpp is a main for where neither is at hand.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>

#include "saltus/numerics/problems.hpp"
#include "saltus/numerics/solvers/registry.hpp"

namespace saltus {
namespace {

using Long = long double;  // neither rounding nor overflow of double is in what is computed here

// ---- Bytes become a problem. Whatever comes behind the end of the bytes is zero.

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  int byte() { return at_ < size_ ? data_[at_++] : 0; }
  int below(int n) { return byte() % n; }
  bool once_in(int n) { return below(n) == n - 1; }

  double whole() { return below(7) - 3; }
  double smooth() { return (byte() * 256 + byte()) / 32768.0 - 1.0; }
  double power(int most) { return std::pow(10.0, std::round(smooth() * most)); }
  double raw() {
    std::uint64_t bits = 0;
    for (int k = 0; k < 8; ++k) bits = bits << 8 | static_cast<std::uint64_t>(byte());
    return std::bit_cast<double>(bits);
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

enum class Numbers { whole, smooth, spread, raw };

double number(Bytes& bytes, Numbers kind) {
  switch (kind) {
    case Numbers::whole: return bytes.whole();
    case Numbers::smooth: return bytes.smooth();
    case Numbers::spread: return bytes.smooth() * bytes.power(150);
    case Numbers::raw: break;
  }
  return bytes.raw();
}

Numbers numbers(Bytes& bytes) {
  constexpr Numbers likely[] = {Numbers::whole,  Numbers::whole,  Numbers::whole,  Numbers::smooth,
                                Numbers::smooth, Numbers::smooth, Numbers::spread, Numbers::raw};
  return likely[bytes.below(8)];
}

Matrix matrix(Bytes& bytes, int rows, int columns) {
  const Numbers kind = numbers(bytes);
  Matrix result(rows, columns);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) result(i, j) = number(bytes, kind);
  return result;
}

std::vector<ContactSet> sets(Bytes& bytes) {
  constexpr double coefficients[] = {0.0, 0.0, 0.3, 0.3, 0.5, 1.0, 10.0, 1e6, 1e160, 1e300};
  const int first = bytes.below(9), second = bytes.below(9);  // few contacts as a rule: they take less time
  std::vector<ContactSet> result;
  for (int k = std::min(first, second); k > 0; --k) {
    const int kind = bytes.below(6);
    if (kind == 0)
      result.push_back(Equality{});
    else if (kind == 1)
      result.push_back(NonNegative{});
    else
      result.push_back(Coulomb{bytes.once_in(32) ? bytes.raw() : coefficients[bytes.below(10)],
                               bytes.once_in(200) ? bytes.below(5)
                               : kind < 4         ? 2
                                                  : 3});
  }
  return result;
}

// WᵀM⁻¹W of any rank, with W at one position or at two, or no structure at all
Matrix coupling(Bytes& bytes, int rows) {
  const int kind = bytes.below(4);
  if (kind == 0) return matrix(bytes, rows, rows);
  const Matrix W = matrix(bytes, 1 + bytes.below(rows + 3), rows);
  if (kind == 1)
    return W.transpose() * (W + bytes.power(12) * matrix(bytes, static_cast<int>(W.rows()), rows));
  return W.transpose() * W;
}

void spoil(Bytes& bytes, Matrix& G) {
  const int rows = static_cast<int>(G.rows());
  if (bytes.once_in(4)) G.row(bytes.below(rows)).setZero();
  if (bytes.once_in(4)) G.col(bytes.below(rows)).setZero();
  if (bytes.once_in(4)) G.row(bytes.below(rows)) = G.row(bytes.below(rows)).eval();
  if (bytes.once_in(4)) G *= bytes.power(150);
  if (bytes.once_in(4)) {  // D G D
    for (int i = 0; i < rows; ++i) {
      const double d = bytes.power(75);
      G.row(i) *= d;
      G.col(i) *= d;
    }
  }
}

Vec right_side(Bytes& bytes, const Matrix& G) {
  const int rows = static_cast<int>(G.rows());
  const bool in_range = bytes.once_in(2);
  Vec b = matrix(bytes, rows, 1);
  if (in_range) b = (G * b).eval();
  if (bytes.once_in(4)) b *= bytes.power(150);
  return b;
}

ContactProblem decode(Bytes& bytes) {
  constexpr double tolerances[] = {default_tolerance, default_tolerance, 1e-6, 1e-15};
  ContactProblem problem{.sets = sets(bytes), .tolerance = tolerances[bytes.below(4)]};
  int rows = bytes.once_in(100) ? 1 : 0;  // too many
  for (const ContactSet& set : problem.sets) rows += rows_of(set);
  if (rows == 0) return problem;
  Matrix G = coupling(bytes, rows);
  spoil(bytes, G);
  problem.b = right_side(bytes, G);
  problem.G = G;
  return problem;
}

// The same with sparse rows, without its zeros or with them
ContactProblem sparse(const ContactProblem& problem, bool zeros) {
  ContactProblem copy{{}, problem.b, problem.sets, problem.tolerance};
  for (int i = 0; i < problem.G.rows(); ++i) {
    for (int j = 0; j < problem.G.cols(); ++j)
      if (zeros || problem.G(i, j) != 0.0) copy.sparse.add(j, problem.G(i, j));
    copy.sparse.end_row();
  }
  return copy;
}

Vec warm_start(Bytes& bytes, int rows) {
  Vec start = Vec::Zero(rows);
  if (bytes.once_in(2)) start = matrix(bytes, rows, 1) * bytes.power(20);
  for (double& value : start)
    if (!std::isfinite(value)) value = 0.0;
  return start;
}

// ---- What is promised of an answer

struct Laws {
  Long residual = 0.0;  // of the natural map
  Long terms = 0.0;     // what cancels in G P + b
  Long forces = 0.0;    // what cancels in the natural map beside them
};

Long length(const Long* x, int count) { return count == 2 ? std::hypot(x[0], x[1]) : std::abs(x[0]); }

Long scale_of(const ContactProblem& problem, int row, int rows) {
  Long scale = 0.0;
  for (int i = row; i < row + rows; ++i)
    scale = std::max(scale, std::abs(Long(saltus::entry(problem, i, i))));
  return scale == 0.0L ? 1.0L : scale;
}

std::vector<Long> velocities(const ContactProblem& problem, const double* P, Long& terms) {
  std::vector<Long> xi(problem.rows());
  for (int i = 0; i < problem.rows(); ++i) {
    Long size = std::abs(problem.b[i]);
    xi[i] = problem.b[i];
    for (int j = 0; j < problem.rows(); ++j) {
      const Long term = Long(entry(problem, i, j)) * P[j];
      xi[i] += term;
      size += std::abs(term);
    }
    terms = std::max(terms, size);
  }
  return xi;
}

// |T - proj(T - xi)| on the disc
Long friction_entry(const Long* T, const Long* xi, Long radius, int count) {
  Long outside[2] = {}, entry[2] = {};
  for (int k = 0; k < count; ++k) outside[k] = T[k] - xi[k];
  const Long size = length(outside, count);
  if (size <= radius) return length(xi, count);
  for (int k = 0; k < count; ++k) entry[k] = T[k] - radius * (outside[k] / size);
  return length(entry, count);
}

// The residual of certificate.hpp
Laws natural_map(const ContactProblem& problem, const double* P) {
  Laws laws;
  const std::vector<Long> xi = velocities(problem, P, laws.terms);
  int row = 0;
  for (const ContactSet& set : problem.sets) {
    const int rows = rows_of(set);
    Long force[3] = {}, entry = std::abs(xi[row]);
    const Long d = scale_of(problem, row, rows);
    if (!std::holds_alternative<Equality>(set)) {
      for (int k = 0; k < rows; ++k) {
        force[k] = d * P[row + k];
        laws.forces = std::max(laws.forces, std::abs(force[k]));
      }
      entry = std::abs(force[0] - std::max(force[0] - xi[row], 0.0L));
    }
    laws.residual = std::max(laws.residual, entry);
    if (const auto* law = std::get_if<Coulomb>(&set)) {
      const double pressing = static_cast<double>(d) * std::max(P[row], 0.0);  // may be too small for double
      const Long radius = law->mu * Long(pressing);
      laws.residual = std::max(laws.residual, friction_entry(force + 1, &xi[row + 1], radius, rows - 1));
    }
    row += rows;
  }
  return laws;
}

// Squared entry of De Saxcé's natural map, with force and velocity as velocities
Long cone_entry(const Coulomb& law, Long d, const double* P, const Long* u, Long terms, Long& rounding) {
  const Long mu = law.mu, sliding = length(u + 1, law.dim - 1);
  Long x[3], y[2] = {};
  for (int k = 0; k < law.dim; ++k) x[k] = d * P[k] - u[k];
  for (int k = 1; k < law.dim; ++k) y[k - 1] = x[k];
  x[0] -= mu * sliding;
  const Long tangential = length(y, law.dim - 1);
  rounding = std::max(rounding, (1.0L + mu) * (terms + d * std::abs(P[0]) + tangential));
  Long normal = x[0], shrink = 1.0L;
  if (x[0] < 0.0L || tangential > mu * x[0]) {  // outside: on the edge, or at the tip
    normal = std::max(0.0L, (x[0] + mu * tangential) / (1.0L + mu * mu));
    shrink = tangential > 0.0L ? mu * normal / tangential : 0.0L;
  }
  Long sum = (d * P[0] - normal) * (d * P[0] - normal);
  for (int k = 1; k < law.dim; ++k) sum += (d * P[k] - shrink * x[k]) * (d * P[k] - shrink * x[k]);
  return sum;
}

// The residual of problems.hpp, and the part of it that may be rounding
Long residual_of(const ContactProblem& problem, const double* P, Long& rounding) {
  Long terms = 0.0, worst = 0.0, squares = 0.0, norm = 0.0, largest_P = 0.0, largest_b = 0.0,
       squares_of_b = 0.0;
  const std::vector<Long> w = velocities(problem, P, terms);
  const Long d = scale_of(problem, 0, problem.rows());
  bool friction = false;
  int row = 0;
  rounding = terms += 1e-300L;  // denormal numbers have few digits
  for (const ContactSet& set : problem.sets) {
    const auto* law = std::get_if<Coulomb>(&set);
    friction |= law != nullptr;
    Long entry = std::abs(w[row]), force = d * P[row];
    if (std::holds_alternative<NonNegative>(set)) {
      worst = std::max(worst, std::abs(std::min(w[row], Long(P[row]))));
      entry = std::min(w[row], force);
      rounding = std::max(rounding, std::abs(force));
    } else {
      worst = std::max(worst, entry);
    }
    squares += law ? cone_entry(*law, d, P + row, &w[row], terms, rounding) : entry * entry;
    row += rows_of(set);
  }
  for (int i = 0; i < row; ++i) {
    Long sum = 0.0;
    for (int j = 0; j < row; ++j) sum += std::abs(Long(saltus::entry(problem, i, j)));
    norm = std::max(norm, sum);
    largest_P = std::max(largest_P, std::abs(Long(P[i])));
    largest_b = std::max(largest_b, std::abs(Long(problem.b[i])));
    squares_of_b += Long(problem.b[i]) * problem.b[i];
  }
  const Long size = friction ? std::sqrt(squares_of_b) : largest_b + norm * largest_P;
  const Long unit = size > 0.0 ? size : 1.0L;
  rounding *= 256.0L * std::numeric_limits<double>::epsilon() / unit;
  return (friction ? std::sqrt(squares) : worst) / unit;
}

const ContactProblem* running = nullptr;  // what is printed where a promise is broken
const Vec* running_start = nullptr;

void require(bool holds, const std::string& solver, const char* promise) {
  if (holds) return;
  std::cerr << std::setprecision(17) << (running->is_sparse() ? "sparse G =\n" : "G =\n")
            << (running->is_sparse() ? dense(*running) : *running).G.view()
            << "\nb = " << running->b.view().transpose();
  std::cerr << "\nsets =";
  for (const ContactSet& set : running->sets) {
    const auto* law = std::get_if<Coulomb>(&set);
    std::cerr << (law ? " Coulomb " : std::holds_alternative<Equality>(set) ? " Equality" : " NonNegative");
    if (law) std::cerr << law->mu << ' ' << law->dim;
  }
  std::cerr << "\ntolerance = " << running->tolerance << "\nstart = " << running_start->transpose()
            << "\nfuzz: " << solver << ": broken: " << promise << std::endl;
  std::abort();
}

bool finite(const Vec& x) { return x.allFinite(); }
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void judge(const std::string& name, const ContactProblem& problem, const SolveReport& report, const Vec& P) {
  PoolVec xi;
  xi.resize(problem.rows());
  const Certificate certificate = certify(problem, P.data(), xi.data());
  const bool solved = report.status == SolveStatus::solved;
  require(same(certificate.residual, report.certificate.residual) &&
              same(certificate.scale, report.certificate.scale),
          name, "the certificate is that of P");
  require(solved == certificate.within(problem.tolerance), name, "solved where the certificate says so");
  require(report.iterations >= 0 && !report.solver.empty(), name, "iterations and the name of the method");
  if (!solved) return;
  require(finite(P), name, "an answer is finite");
  const Laws laws = natural_map(problem, P.data());
  const Long rounding = 32.0L * std::numeric_limits<double>::epsilon() * (laws.terms + laws.forces);
  require(laws.residual <= 1.001L * problem.tolerance * laws.terms + rounding + 1e-320L, name,
          "an answer satisfies the laws");
}

void judge(const std::string& name, const ContactProblem& problem, const ProblemSolution& answer) {
  if (problem.rows() > 0)
    require(same(answer.residual, problem_residual(problem, answer.solution.data())), name,
            "the residual is that of the solution");
  const bool solved = answer.status == SolveStatus::solved;
  require(solved == (answer.residual <= problem.tolerance), name,
          "a problem is solved where its residual says so");
  require(solved || !answer.unique, name, "what is no solution is not the only one");
  if (!solved) return;
  require(finite(answer.solution), name, "a solution is finite");
  Long rounding = 0.0;
  const Long residual = residual_of(problem, answer.solution.data(), rounding);
  require(residual <= 1.001L * problem.tolerance + rounding, name, "a solution has a small residual");
}

template <class Function>
bool refused(Function function) {
  try {
    function();
    return false;
  } catch (const std::invalid_argument&) {
    return true;
  }
}

void run(const SolverEntry& entry, const ContactProblem& given, const Vec& start, bool twice) {
  const auto solver = entry.make();
  const ContactProblem problem = given.is_sparse() && !solver->takes_sparse() ? dense(given) : given;
  if (!solver->accepts(problem)) {
    require(refused([&] { solve_problem(problem, *solver, problem.tolerance, start); }), entry.name,
            "what is not accepted is refused");
    return;
  }
  solver->reserve(problem.rows());
  Vec P = start;
  const SolveReport report = solver->solve(problem, P.data());
  judge(entry.name, problem, report, P);
  judge(entry.name, problem, solve_problem(problem, *solver, problem.tolerance, start));
  if (!twice) return;
  const auto other = solver->clone();
  other->reserve(problem.rows());
  for (ContactSolver* either : {solver.get(), other.get()}) {
    Vec again = start;
    either->solve(problem, again.data());
    for (int i = 0; i < problem.rows(); ++i)
      require(same(P[i], again[i]), entry.name, "the same answer again");
  }
}

}  // namespace
}  // namespace saltus

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace saltus;
  Bytes bytes(data, size);
  const bool twice = bytes.once_in(4);
  const int storage = bytes.below(4);  // dense, dense, sparse, sparse with zeros
  ContactProblem problem = decode(bytes);
  if (storage >= 2) problem = sparse(problem, storage == 3);
  const Vec start = warm_start(bytes, problem.rows());
  running = &problem;
  running_start = &start;
  const bool invalid = refused([&] { validate(problem); });
  for (const SolverEntry& entry : contact_solvers()) {
    if (invalid) {
      require(refused([&] { solve_problem(problem, *entry.make(), problem.tolerance, start); }), entry.name,
              "what is invalid is refused");
      continue;
    }
    try {
      run(entry, problem, start, twice);
    } catch (const std::exception& error) {
      require(false, entry.name, error.what());
    }
  }
  return 0;
}

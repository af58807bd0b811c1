#include "saltus/kernel/assembly/force_elements.hpp"

namespace saltus {
namespace {

// Storage of one call, kept for the next one in this thread. A relation may run another simulation: a call
// within a call gets storage of its own.
class Storage {
 public:
  explicit Storage(int size) : values_(std::move(idle_)) {
    if (values_.size() < static_cast<std::size_t>(size)) values_.resize(size);
  }
  ~Storage() { idle_ = std::move(values_); }
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;
  double* data() { return values_.data(); }

 private:
  static thread_local std::vector<double> idle_;
  std::vector<double> values_;
};

thread_local std::vector<double> Storage::idle_;

}  // namespace

Stretch stretch(const Layout& layout, const Layout::Force& force, double t, const Vec& q, const Vec& v,
                double* storage) {
  Stretch state{layout.local_position(force, q, storage), layout.local(force, v, storage + force.coordinates),
                0.0, 0.0, storage + force.coordinates + force.n};
  std::fill_n(state.W, force.n, 0.0);
  const Relation& relation = force.element->relation();
  relation.gap_at(t, state.q, {&state.length, 1});
  relation.jacobian_at(t, state.q, {state.W, 1, force.n});
  relation.motion_at(t, state.q, {&state.rate, 1});
  for (int j = 0; j < force.n; ++j) state.rate += state.W[j] * state.v[j];
  return state;
}

void add_element_forces(const Layout& layout, double t, const Vec& q, const Vec& v, Vec& h) {
  Storage storage(3 * layout.largest_force);
  for (const auto& force : layout.forces) {
    const Stretch state = stretch(layout, force, t, q, v, storage.data());
    const double f = force.element->law().force(t, state.length, state.rate);
    const double* W = state.W;
    for (int side = 0; side < force.sides; ++side) {
      const auto& system = layout.systems[force.system[side]];
      for (int j = 0; j < system.n; ++j) h[system.offset + j] += *W++ * f;
    }
  }
}

double element_energy(const Layout& layout, double t, const Vec& q) {
  Storage storage(layout.largest_force);
  double energy = 0.0;
  for (const auto& force : layout.forces) {
    double length = 0.0;
    force.element->relation().gap_at(t, layout.local_position(force, q, storage.data()), {&length, 1});
    energy += force.element->law().potential_energy(length);
  }
  return energy;
}

}  // namespace saltus

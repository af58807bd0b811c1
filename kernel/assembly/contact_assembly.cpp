#include "saltus/kernel/assembly/contact_assembly.hpp"

#include <algorithm>

namespace saltus {
namespace {

// Beyond this many rows the storage of G grows when it is first needed: all contacts at once are rare.
constexpr int reserved_rows = 256;

}  // namespace

ContactAssembly::ContactAssembly(std::shared_ptr<const Layout> layout,
                                 std::shared_ptr<const Partition> partition, bool sparse)
    : layout_(std::move(layout)),
      partition_(std::move(partition)),
      sparse_(sparse),
      answered_with_(layout_->contacts.size(), 0),
      touching_(partition_->blocks.size()) {
  const int rows = sparse_ ? 0 : std::min(layout_->rows, reserved_rows);
  problem_.G.reserve(rows, rows);
  problem_.tolerance = layout_->tolerance;
  problem_.b.reserve(layout_->rows);
  problem_.sets.reserve(layout_->rows);
  active_.reserve(layout_->contacts.size());
  first_row_.reserve(layout_->contacts.size());
  touched_.reserve(touching_.size());
  std::vector<int> sides_on(touching_.size(), 0);
  for (const auto& contact : layout_->contacts) {
    place(contact);
    for (int side = 0; side < contact.sides; ++side)
      ++sides_on[partition_->places[contact.system[side]].block];
  }
  for (std::size_t k = 0; k < touching_.size(); ++k) touching_[k].reserve(sides_on[k]);
}

// A force on one system of a block moves all of them.
void ContactAssembly::place(const Layout::Contact& contact) {
  Extent extent{minv_w_.size(), 0, 0, {0, 0}, spans_.size(), 0};
  for (int side = 0; side < contact.sides; ++side) {
    const int block = partition_->places[contact.system[side]].block;
    if (side > 0 && block == partition_->places[contact.system[0]].block) continue;  // at column 0 as well
    extent.column[side] = extent.width;
    for (int system : partition_->blocks[block])
      spans_.push_back({layout_->systems[system].offset, layout_->systems[system].n});
    extent.width += partition_->sizes[block];
    ++extent.blocks;
  }
  extent.last_span = spans_.size();
  extents_.push_back(extent);
  minv_w_.resize(minv_w_.size() + static_cast<std::size_t>(contact.rows) * extent.width);
}

void ContactAssembly::assemble(const std::vector<int>& active, Configuration& constraint,
                               Configuration& force, const BlockInverse& inverse) {
  const long revision = inverse.revision(), known = layout_->varying_jacobian ? 0 : revision;
  const bool same = active == active_;
  if (known != 0 && known == made_with_ && same) return;  // G is still what it was
  made_with_ = known;
  if (!same) choose(active);
  for (int contact : active_) {
    const bool constant = revision != 0 && layout_->contacts[contact].constant_jacobian;
    if (constant && answered_with_[contact] == revision) continue;
    respond(contact, force.jacobian(contact), inverse);
    answered_with_[contact] = constant ? revision : 0;
  }
  constrain(constraint);
}

void ContactAssembly::constrain(Configuration& constraint) {
  if (sparse_)
    std::fill(problem_.sparse.value.begin(), problem_.sparse.value.end(), 0.0);
  else
    problem_.G.view().setZero();
  for (int block : touched_) assemble_shared(block, constraint);
}

// Laws, size and structure of the problem of some contacts
void ContactAssembly::choose(const std::vector<int>& active) {
  active_ = active;
  first_row_.clear();
  problem_.sets.clear();
  for (int block : touched_) touching_[block].clear();
  touched_.clear();
  int row = 0;
  for (std::size_t index = 0; index < active_.size(); ++index) {
    const auto& contact = layout_->contacts[active_[index]];
    for (const ContactSet& set : contact.law->sets) problem_.sets.push_back(set);
    touch(static_cast<int>(index), row);
    first_row_.push_back(row);
    row += contact.rows;
  }
  problem_.b.resize(row);
  if (!sparse_) {
    problem_.G.resize(row, row);
    return;
  }
  problem_.sparse.clear();
  neighbours_.clear();
  first_neighbour_.clear();
  for (std::size_t index = 0; index < active_.size(); ++index) find_neighbours(static_cast<int>(index));
}

// The sparse rows of a contact: a column for every row of the contacts on its one or two blocks, in order
void ContactAssembly::find_neighbours(int index) {
  const auto& contact = layout_->contacts[active_[index]];
  const auto& first = touching_[partition_->places[contact.system[0]].block];
  const auto& second = touching_[partition_->places[contact.system[contact.sides - 1]].block];
  first_neighbour_.push_back(static_cast<int>(neighbours_.size()));
  int width = 0;
  auto a = first.begin(), b = second.begin();
  while (a != first.end() || b != second.end()) {
    const Touch& next = b == second.end() || (a != first.end() && a->index <= b->index) ? *a : *b;
    neighbours_.push_back({next.index, width});
    width += layout_->contacts[active_[next.index]].rows;
    const int taken = next.index;
    while (a != first.end() && a->index == taken) ++a;
    while (b != second.end() && b->index == taken) ++b;
  }
  for (int i = 0; i < contact.rows; ++i) {
    for (std::size_t k = first_neighbour_.back(); k < neighbours_.size(); ++k) {
      const int rows = layout_->contacts[active_[neighbours_[k].index]].rows;
      for (int j = 0; j < rows; ++j) problem_.sparse.add(first_row_[neighbours_[k].index] + j, 0.0);
    }
    problem_.sparse.end_row();
  }
}

// Notes the contact on the blocks of its systems.
void ContactAssembly::touch(int index, int row) {
  const auto& contact = layout_->contacts[active_[index]];
  int column = 0;
  for (int side = 0; side < contact.sides; ++side) {
    const int n = layout_->systems[contact.system[side]].n;
    const auto& [block, offset] = partition_->places[contact.system[side]];
    std::vector<Touch>& touching = touching_[block];
    if (touching.empty()) touched_.push_back(block);
    const bool first = touching.empty() || touching.back().index != index;
    touching.push_back({index, row, n, column, extents_[active_[index]].column[side], offset, first});
    column += n;
  }
}

// (M⁻¹W)ᵀ of a contact
void ContactAssembly::respond(int k, const double* W, const BlockInverse& inverse) {
  const auto& contact = layout_->contacts[k];
  const Extent& extent = extents_[k];
  double* X = minv_w_.data() + extent.start;
  if (extent.width > contact.n) std::fill_n(X, static_cast<std::size_t>(contact.rows) * extent.width, 0.0);
  for (int i = 0; i < contact.rows; ++i, X += extent.width) {
    for (int side = 0; side < contact.sides; ++side) {
      const int n = layout_->systems[contact.system[side]].n;
      std::copy_n(W, n, X + extent.column[side] + partition_->places[contact.system[side]].offset);
      W += n;
    }
    for (int side = 0; side < extent.blocks; ++side)
      inverse.solve_block(partition_->places[contact.system[side]].block, X + extent.column[side]);
  }
}

void ContactAssembly::assemble_shared(int block, Configuration& constraint) {
  for (const Touch& a : touching_[block]) {
    const auto& left = layout_->contacts[active_[a.index]];
    const double* Wa = constraint.jacobian(active_[a.index]) + a.column;
    const Neighbour* neighbour = sparse_ ? neighbours_.data() + first_neighbour_[a.index] : nullptr;
    for (const Touch& b : touching_[block]) {
      if (!b.first) continue;
      const Extent& right = extents_[active_[b.index]];
      const int rows = layout_->contacts[active_[b.index]].rows;
      const double* Xb = minv_w_.data() + right.start + b.block_column + a.offset;
      if (sparse_)
        while (neighbour->index != b.index) ++neighbour;
      for (int i = 0; i < left.rows; ++i) {
        double* to =
            sparse_ ? problem_.sparse.row(a.row + i) + neighbour->column : problem_.G.row(a.row + i) + b.row;
        for (int j = 0; j < rows; ++j)
          for (int k = 0; k < a.n; ++k) to[j] += Wa[i * left.n + k] * Xb[j * right.width + k];
      }
    }
  }
}

void ContactAssembly::set_b(Configuration& constraint, const Vec& v) {
  int row = 0;
  for (int contact : active_) {
    constraint.relative_velocity(contact, v, problem_.b.data() + row);
    row += layout_->contacts[contact].rows;
  }
}

void ContactAssembly::set_b_of_acceleration(Configuration& constraint, const Vec& v, const Vec& a,
                                            double weight) {
  int row = 0;
  for (int contact : active_) {
    constraint.relative_acceleration(contact, v, a, problem_.b.data() + row);
    row += layout_->contacts[contact].rows;
  }
  problem_.b.view() *= weight;
}

void ContactAssembly::add_restitution(const Vec& gamma) {
  int row = 0;
  for (int contact : active_) {
    const auto& slot = layout_->contacts[contact];
    for (int i = 0; i < slot.rows; ++i) problem_.b[row++] += slot.law->restitution[i] * gamma[slot.row + i];
  }
}

double ContactAssembly::work(const PoolVec& P, Configuration& constraint, const Vec& gamma) const {
  double sum = 0.0;
  int row = 0;
  for (int contact : active_) {
    const auto& slot = layout_->contacts[contact];
    const double* w = slot.rheonomous ? constraint.motion(contact) : nullptr;
    for (int i = 0; i < slot.rows; ++i, ++row) {
      double jump = 0.0;
      for_row(problem_, row, [&](int j, double entry) { jump += entry * P[j]; });
      sum += P[row] * (gamma[slot.row + i] - (w ? w[i] : 0.0) + 0.5 * jump);
    }
  }
  return sum;
}

void ContactAssembly::apply(double factor, const double* P, Vec& v) const {
  for (int contact : active_) {
    const Extent& extent = extents_[contact];
    const double* X = minv_w_.data() + extent.start;
    for (int i = 0; i < layout_->contacts[contact].rows; ++i) {
      const double p = factor * *P++;
      for (std::size_t k = extent.first_span; k < extent.last_span; ++k)
        for (int j = spans_[k].offset; j < spans_[k].offset + spans_[k].n; ++j) v[j] += *X++ * p;
    }
  }
}

void ContactAssembly::gather(const Vec& all, double factor, PoolVec& active) const {
  active.resize(problem_.rows());
  int row = 0;
  for (int contact : active_) {
    const auto& slot = layout_->contacts[contact];
    for (int i = 0; i < slot.rows; ++i) active[row++] = factor * all[slot.row + i];
  }
}

void ContactAssembly::scatter(const PoolVec& active, double factor, Vec& all) const {
  int row = 0;
  for (int contact : active_) {
    const auto& slot = layout_->contacts[contact];
    for (int i = 0; i < slot.rows; ++i) all[slot.row + i] = factor * active[row++];
  }
}

}  // namespace saltus

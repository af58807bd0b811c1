#include "saltus/siconos/live_model.hpp"

#include <BoundaryCondition.hpp>
#include <EqualityConditionNSL.hpp>
#include <Interaction.hpp>
#include <LagrangianDS.hpp>
#include <LagrangianLinearDiagonalDS.hpp>
#include <LagrangianLinearTIDS.hpp>
#include <LagrangianLinearTIR.hpp>
#include <LagrangianRheonomousR.hpp>
#include <LagrangianScleronomousR.hpp>
#include <NewtonImpactFrictionNSL.hpp>
#include <NewtonImpactNSL.hpp>
#include <NonSmoothDynamicalSystem.hpp>
#include <SimpleMatrix.hpp>
#include <SimulationGraphs.hpp>
#include <Topology.hpp>
#include <algorithm>
#include <boost/core/demangle.hpp>
#include <stdexcept>
#include <string>
#include <typeinfo>

namespace saltus::siconos {
namespace {

template <class T>
std::string type_of(const T& object) {
  return boost::core::demangle(typeid(object).name());
}

void copy(const SiconosMatrix& from, OutMatrix to, double factor = 1.0) {
  for (int i = 0; i < to.rows(); ++i)
    for (int j = 0; j < to.cols(); ++j) to(i, j) = factor * from.getValue(i, j);
}

void set_position(::LagrangianDS& ds, const double* q) { std::copy_n(q, ds.dimension(), ds.q()->getArray()); }

void set_velocity(::LagrangianDS& ds, const double* v) {
  std::copy_n(v, ds.dimension(), ds.velocity()->getArray());
}

Vec values(const SiconosVector& vector) {
  Vec result(vector.size());
  for (unsigned i = 0; i < vector.size(); ++i) result[i] = vector.getValue(i);
  return result;
}

class LiveDS final : public saltus::LagrangianDS {
 public:
  explicit LiveDS(SP::LagrangianDS ds)
      : LagrangianDS(values(*ds->q0()), values(*ds->velocity0())),
        ds_(std::move(ds)),
        linear_(std::dynamic_pointer_cast<::LagrangianLinearTIDS>(ds_)),
        diagonal_(std::dynamic_pointer_cast<::LagrangianLinearDiagonalDS>(ds_)) {
    ds_->init_forces();
  }

  void mass(const In& q, OutMatrix M) const override {
    set_position(*ds_, q.data());
    ds_->computeMass(ds_->q());
    if (ds_->mass())
      copy(*ds_->mass(), M);
    else
      M.setIdentity();
  }

  void forces(double t, const In& q, const In& v, Out h) const override {
    set_position(*ds_, q.data());
    set_velocity(*ds_, v.data());
    ds_->computeForces(t, ds_->q(), ds_->velocity());
    if (ds_->forces()) std::copy_n(ds_->forces()->getArray(), h.size(), h.data());
  }

  bool constant_mass() const override { return time_invariant(); }
  bool time_invariant() const override { return linear_ || diagonal_; }

  bool force_jacobians(double, const In&, const In&, OutMatrix dh_dq, OutMatrix dh_dv) const override {
    if (linear_) {
      if (linear_->K()) copy(*linear_->K(), dh_dq, -1.0);
      if (linear_->C()) copy(*linear_->C(), dh_dv, -1.0);
    } else if (diagonal_) {
      if (diagonal_->stiffness()) dh_dq.diagonal() = -values(*diagonal_->stiffness());
      if (diagonal_->damping()) dh_dv.diagonal() = -values(*diagonal_->damping());
    }
    return linear_ || diagonal_;
  }

 private:
  SP::LagrangianDS ds_;
  SP::LagrangianLinearTIDS linear_;
  SP::LagrangianLinearDiagonalDS diagonal_;
};

class LiveRelation final : public saltus::Relation {
 public:
  using Systems = std::vector<SP::LagrangianDS>;

  LiveRelation(SP::Interaction interaction, Systems systems)
      : Relation(static_cast<int>(interaction->dimension())),
        interaction_(std::move(interaction)),
        systems_(std::move(systems)),
        relation_(std::dynamic_pointer_cast<::LagrangianR>(interaction_->relation())),
        scleronomous_(std::dynamic_pointer_cast<::LagrangianScleronomousR>(relation_)),
        rheonomous_(std::dynamic_pointer_cast<::LagrangianRheonomousR>(relation_)),
        linear_(std::dynamic_pointer_cast<::LagrangianLinearTIR>(relation_)) {
    if (!scleronomous_ && !rheonomous_ && !linear_)
      throw std::invalid_argument(
          "a relation must be a LagrangianScleronomousR, a LagrangianRheonomousR or a LagrangianLinearTIR, "
          "got a " +
          type_of(*interaction_->relation()));
  }

  bool rheonomous() const override { return rheonomous_ != nullptr; }
  bool constant_jacobian() const override { return linear_ != nullptr; }
  bool has_curvature() const override { return linear_ || (scleronomous_ && scleronomous_->dotJachq()); }

  void gap_at(double t, const In& q, Out g) const override {
    set_positions(q);
    interaction_->computeOutput(t, 0);
    std::copy_n(interaction_->y(0)->getArray(), g.size(), g.data());
  }

  void jacobian_at(double t, const In& q, OutMatrix J) const override {
    set_positions(q);
    relation_->computeJach(t, *interaction_);
    copy(*relation_->jachq(), J);
  }

  void motion_at(double t, const In& q, Out w) const override {
    if (!rheonomous_) return;
    set_positions(q);
    rheonomous_->computehDot(t, link(::LagrangianR::q0), link(::LagrangianR::z));
    if (rheonomous_->hDot()) std::copy_n(rheonomous_->hDot()->getArray(), w.size(), w.data());
  }

  void curvature_at(double, const In& q, const In& v, Out c) const override {
    if (!has_curvature()) Relation::curvature(q, v, c);
    if (linear_) return;
    set_positions(q);
    const double* from = v.data();
    for (const auto& ds : systems_) {
      set_velocity(*ds, from);
      from += ds->dimension();
    }
    scleronomous_->computeDotJachq(link(::LagrangianR::q0), link(::LagrangianR::z), link(::LagrangianR::q1));
    const SimpleMatrix& rate = *scleronomous_->dotJachq();
    for (int i = 0; i < size(); ++i)
      for (Eigen::Index j = 0; j < v.size(); ++j) c[i] += rate.getValue(i, j) * v[j];
  }

  // Never asked for: those with the time are overridden.
  void gap(const In& q, Out g) const override { gap_at(0.0, q, g); }
  void jacobian(const In& q, OutMatrix J) const override { jacobian_at(0.0, q, J); }

 private:
  void set_positions(const In& q) const {
    const double* from = q.data();
    for (const auto& ds : systems_) {
      set_position(*ds, from);
      from += ds->dimension();
    }
  }

  BlockVector& link(int which) const { return *interaction_->linkToDSVariables()[which]; }

  SP::Interaction interaction_;
  Systems systems_;
  SP::LagrangianR relation_;
  SP::LagrangianScleronomousR scleronomous_;
  SP::LagrangianRheonomousR rheonomous_;
  SP::LagrangianLinearTIR linear_;
};

NonSmoothLaw law_of(const ::NonSmoothLaw& law) {
  if (const auto* friction = dynamic_cast<const ::NewtonImpactFrictionNSL*>(&law))
    return saltus::NewtonImpactFrictionNSL(friction->en(), friction->et(), friction->mu(),
                                           static_cast<int>(friction->size()));
  if (const auto* impact = dynamic_cast<const ::NewtonImpactNSL*>(&law); impact && impact->size() == 1)
    return saltus::NewtonImpactNSL(impact->e());
  if (dynamic_cast<const ::EqualityConditionNSL*>(&law))
    return saltus::EqualityConditionNSL(static_cast<int>(law.size()));
  throw std::invalid_argument(
      "a law must be a NewtonImpactNSL of one row, a NewtonImpactFrictionNSL or an EqualityConditionNSL, got "
      "a " +
      type_of(law) + " of " + std::to_string(law.size()) + " rows");
}

SP::LagrangianDS lagrangian(const SP::DynamicalSystem& ds) {
  auto system = std::dynamic_pointer_cast<::LagrangianDS>(ds);
  if (!system) throw std::invalid_argument("a system must be a LagrangianDS, got a " + type_of(*ds));
  if (system->boundaryConditions())
    throw std::invalid_argument("a system must have no boundary conditions, got a " +
                                type_of(*system->boundaryConditions()) + " of system " +
                                std::to_string(system->number()));
  return system;
}

std::string name_of(InteractionsGraph& graph, const InteractionsGraph::VDescriptor& vertex) {
  if (graph.name.hasKey(vertex)) return graph.name[vertex];
  return "interaction " + std::to_string(graph.bundle(vertex)->number());
}

}  // namespace

LiveModel adopt(::NonSmoothDynamicalSystem& nsds, double t0) {
  std::vector<SP::LagrangianDS> systems;
  saltus::NonSmoothDynamicalSystem::Systems live;
  for (const auto& ds : nsds.dynamicalSystemsVector()) {
    systems.push_back(lagrangian(ds));
    live.push_back(std::make_shared<LiveDS>(systems.back()));
  }
  LiveModel result{saltus::NonSmoothDynamicalSystem(live, t0), systems, {}};

  const auto live_of = [&](const SP::DynamicalSystem& ds) -> const saltus::LagrangianDS& {
    return *live[std::find(systems.begin(), systems.end(), ds) - systems.begin()];
  };
  InteractionsGraph& graph = *nsds.topology()->indexSet0();
  InteractionsGraph::VIterator vertex, end;
  for (std::tie(vertex, end) = graph.vertices(); vertex != end; ++vertex) {
    const SP::Interaction interaction = graph.bundle(*vertex);
    const SP::DynamicalSystem first = graph.properties(*vertex).source;
    const SP::DynamicalSystem second = graph.properties(*vertex).target;
    LiveRelation::Systems linked;
    for (const auto& ds : {first, second})
      if (linked.empty() || second != first) linked.push_back(lagrangian(ds));
    result.model.link(
        std::make_shared<saltus::Interaction>(std::make_shared<LiveRelation>(interaction, linked),
                                              law_of(*interaction->nonSmoothLaw()), name_of(graph, *vertex)),
        live_of(first), second == first ? nullptr : &live_of(second));
    result.interactions.push_back(interaction);
  }
  return result;
}

}  // namespace saltus::siconos

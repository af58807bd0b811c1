// Many contacts: G by sparse rows, and steps that stay exact.
#include <gtest/gtest.h>

#include <random>

#include "saltus/kernel/assembly/contact_assembly.hpp"
#include "saltus/kernel/integrators/moreau_jean/activity.hpp"
#include "saltus/kernel/model/neighbours.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

// n balls of 1 kg on each other and on the ground, every contact closed by 1e-9 m
NonSmoothDynamicalSystem column(int n) {
  NonSmoothDynamicalSystem::Systems balls;
  for (int k = 0; k < n; ++k)
    balls.push_back(std::make_shared<LagrangianLinearTIDS>(
        vec({-1e-9 * (k + 1)}), vec({0.0}), Matrix::Identity(1, 1),
        LagrangianLinearTIDS::Terms{.external_force = vec({-gravity})}));
  NonSmoothDynamicalSystem model(balls);
  for (int k = 0; k < n; ++k) {
    const Matrix H = k == 0 ? Matrix(Matrix::Identity(1, 1)) : Matrix((Matrix(1, 2) << -1.0, 1.0).finished());
    model.link(linear_contact(H, vec({0.0}), NewtonImpactNSL(0.0), ""), *balls[k == 0 ? 0 : k - 1],
               k == 0 ? nullptr : balls[k].get());
  }
  return model;
}

class ManyContacts : public testing::TestWithParam<std::string> {};

TEST_P(ManyContacts, AColumnCarriesItsWeight) {
  const int n = 200;
  const double dt = 1e-3;
  const auto rows = rows_of_run(column(n), *make_scheme(GetParam()), dt, 0.005);
  ASSERT_EQ(rows.size(), 6u);
  for (std::size_t step = 1; step < rows.size(); ++step)
    for (int k = 0; k < n; ++k) {
      const Reactions& reactions = rows[step].reactions;
      const double carried = reactions.impulse[k] + dt * reactions.force[k];
      EXPECT_NEAR(carried, (n - k) * gravity * dt, 1e-9 * (n - k) * gravity * dt) << step << " " << k;
    }
}

INSTANTIATE_TEST_SUITE_P(Schemes, ManyContacts, testing::ValuesIn(scheme_names()),
                         [](const auto& test) { return test.param; });

// A closed gap that rounding has opened stays active, and what another body does far away closes no gap.
TEST(Activity, GoesByTheContactsOwnVelocity) {
  const auto ball = [](double gap, double velocity) {
    return std::make_shared<LagrangianLinearTIDS>(vec({gap}), vec({velocity}), Matrix::Identity(1, 1));
  };
  const NonSmoothDynamicalSystem::Systems balls = {ball(1e-5, -1e-3), ball(1e3, -1e5),
                                                   ball(1.0 + 1e-16, 0.0)};
  NonSmoothDynamicalSystem model(balls);
  const Matrix H = Matrix::Identity(1, 1);
  const double floors[] = {0.0, 0.0, -std::nextafter(1.0, 0.0)};  // the last gap is 1.1e-16
  for (int k = 0; k < 3; ++k)
    model.link(linear_contact(H, vec({floors[k]}), NewtonImpactNSL(0.0), ""), *balls[k]);
  const auto layout = std::make_shared<Layout>(model, 1e-4);
  Configuration start(layout);
  start.move_to(model.q0(), model.t0());
  ASSERT_GT(start.gaps()[2], 0.0);
  Vec gamma = Vec::Zero(3);
  std::vector<int> active;
  ASSERT_TRUE(predict_active(*layout, start, model.v0(), 1e-3, gamma, active));
  EXPECT_EQ(active, std::vector<int>{2});
}

// Blocks in a row, each with two frictional contacts to the next one and one to the ground
NonSmoothDynamicalSystem row_of_blocks(int n) {
  NonSmoothDynamicalSystem::Systems blocks;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int k = 0; k < n; ++k) {
    Matrix A(3, 3);
    for (double& x : A.reshaped()) x = normal(random);
    const Matrix M = A * A.transpose() + Matrix::Identity(3, 3);
    blocks.push_back(std::make_shared<LagrangianLinearTIDS>(vec({0.0, 0.0, 0.0}), vec({0.0, 0.0, 0.0}), M));
  }
  NonSmoothDynamicalSystem model(blocks);
  auto link = [&](int freedoms, const LagrangianDS& first, const LagrangianDS* second) {
    Matrix H(2, freedoms);
    for (double& x : H.reshaped()) x = normal(random);
    model.link(linear_contact(H, vec({0.0, 0.0}), NewtonImpactFrictionNSL(0.0, 0.0, 0.3, 2), ""), first,
               second);
  };
  for (int k = 0; k < n; ++k) {
    link(3, *blocks[k], nullptr);
    if (k + 1 == n) break;
    link(6, *blocks[k], blocks[k + 1].get());
    link(6, *blocks[k + 1], blocks[k].get());
  }
  return model;
}

TEST(SparseAssembly, IsTheDenseOne) {
  const NonSmoothDynamicalSystem model = row_of_blocks(6);
  const auto layout = std::make_shared<Layout>(model);
  Configuration at(layout);
  at.move_to(model.q0(), model.t0());
  ASSERT_TRUE(at.factorise());
  // Together in pairs as well, as force elements would have it: then the two ends share a block.
  const auto pairs = std::make_shared<Partition>();
  pairs->blocks = {{0, 1}, {2, 3}, {4, 5}};
  pairs->sizes = {6, 6, 6};
  for (int k = 0; k < 6; ++k) pairs->places.push_back({k / 2, 3 * (k % 2)});
  struct InPairs final : BlockInverse {
    explicit InPairs(const Configuration& configuration) : of(configuration) {}
    void solve_block(int block, double* x) const override {
      of.solve_block(2 * block, x);
      of.solve_block(2 * block + 1, x + 3);
    }
    const Configuration& of;
  } in_pairs(at);
  for (const bool paired : {false, true}) {
    const std::shared_ptr<const Partition> partition = paired ? pairs : one_block_a_system(*layout);
    const BlockInverse& inverse = paired ? static_cast<const BlockInverse&>(in_pairs) : at;
    ContactAssembly dense(layout, partition), sparse(layout, partition, true);
    for (const std::vector<int>& active :
         {std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
          {1, 2, 4, 9, 15},
          {7},
          {}}) {
      dense.assemble(active, at, at, inverse);
      sparse.assemble(active, at, at, inverse);
      ASSERT_EQ(sparse.problem().rows(), 2 * static_cast<int>(active.size()));
      EXPECT_EQ(saltus::dense(sparse.problem()).G.view(), dense.problem().G.view())
          << paired << active.size();
    }
    sparse.assemble({0, 15}, at, at, inverse);  // far from each other
    EXPECT_EQ(sparse.problem().sparse.value.size(), 8u);
  }
}

std::vector<std::array<int, 2>> all_pairs(const Matrix& centres, const Vec& radii, double within) {
  std::vector<std::array<int, 2>> pairs;
  for (int i = 0; i < centres.rows(); ++i)
    for (int j = i + 1; j < centres.rows(); ++j)
      if ((centres.row(i) - centres.row(j)).norm() - radii[i] - radii[j] <= within) pairs.push_back({i, j});
  return pairs;
}

TEST(Neighbours, AreThoseOfAllPairs) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1.0, 1.0), size(0.0, 0.1);
  for (int dim = 1; dim <= 3; ++dim)
    for (const double within : {-0.02, 0.0, 0.05}) {
      Matrix centres(200, dim);
      Vec radii(200);
      for (double& x : centres.reshaped()) x = place(random);
      for (double& r : radii) r = size(random);
      const auto expected = all_pairs(centres, radii, within);
      ASSERT_GT(expected.size(), 5u);
      EXPECT_EQ(neighbours(centres, radii, within), expected) << dim << " " << within;
    }
}

TEST(Neighbours, TouchInALattice) {
  // Whole numbers: distances of 2 R are exact, and lie on the borders of cells.
  const int n = 30;
  Matrix centres(n * n, 2);
  for (int i = 0; i < n * n; ++i) centres.row(i) << 2.0 * (i / n) - n, 2.0 * (i % n) - n;
  EXPECT_EQ(neighbours(centres, Vec::Ones(n * n), 0.0).size(), 2u * n * (n - 1));
  EXPECT_EQ(neighbours(centres, Vec::Ones(n * n), 2.0 * std::sqrt(2.0) - 2.0 + 1e-12).size(),
            2u * n * (n - 1) + 2u * (n - 1) * (n - 1));
  EXPECT_TRUE(neighbours(centres, Vec::Ones(n * n), -1e-12).empty());
  EXPECT_EQ(neighbours(Matrix::Zero(3, 3), Vec::Zero(3), 0.0).size(), 3u);
}

TEST(Neighbours, RefuseWhatIsNoSphere) {
  const Matrix centres = Matrix::Zero(2, 2);
  expect_refusal([&] { neighbours(centres, Vec::Ones(3), 0.0); }, {"radii must have 2 entries", "got 3"});
  expect_refusal([&] { neighbours(centres, -Vec::Ones(2), 0.0); }, {"radii must be >= 0", "-1"});
  expect_refusal([&] { neighbours(centres, Vec::Ones(2), NAN); }, {"must be finite"});
  expect_refusal([&] { neighbours(Matrix::Zero(2, 4), Vec::Ones(2), 0.0); }, {"1 to 3 columns", "got 4"});
}

}  // namespace
}  // namespace saltus::test

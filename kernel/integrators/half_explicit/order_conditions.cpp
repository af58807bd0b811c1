// Order conditions by rooted trees, one a tree: Σ b_i φ_i = 1/γ. Without constraints see Hairer, Norsett,
// Wanner, Solving ODEs I, II.2. With them, q̇ = v, M(q)v̇ = h(t,q,v) + W(q)λ, 0 = W(q)ᵀv is a
// differential-algebraic equation ẏ = f(y,λ), 0 = g(y) of index 2, whose trees have two kinds of vertices
// (Hairer, Lubich, Roche, Lecture Notes in Mathematics 1409; Brasey and Hairer, SIAM J. Numer. Anal. 30,
// 1993; Solving ODEs II, VII.5-6):
//   meagre   a derivative of f; children are meagre, at most one is fat, because f is linear in λ;
//   fat      a derivative of g, solved for λ by (-g_y f_λ)⁻¹; children are meagre.
// Two kinds of trees say nothing new: a fat vertex over a single leaf (g_y f = 0), and a meagre vertex over a
// single fat one, for Σ_j a_ij ω_jk = δ_ik puts the children of the fat one in its place. Mechanics needs
// less than the general equation, from order 5 on. W depends on q only, so derivatives by q alone stand
// beside λ, and beside all but one child of a fat vertex. As q̇ = v, these are v, a leaf, and v̇, a vertex with
// one child; if that is one over a fat one, the children of the fat one have taken its place.
#include "saltus/kernel/integrators/half_explicit/order_conditions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <stdexcept>
#include <string>

namespace saltus {
namespace {

struct Tree {
  int order;                  // a fat one's: that of its children less 1
  std::vector<int> children;  // meagre ones, ascending
  int multiplier = -1;        // the fat child of a meagre one
  bool position = false;      // may be a derivative by q
  bool constrained = false;   // has a fat vertex
  int over = 1, under = 1;    // 1/γ
  std::string text = {};
};

// All trees up to highest_order, by ascending order: a child stands before its parent.
struct Trees {
  std::vector<Tree> meagre, fat;

  Trees() {
    for (int order = 1; order <= highest_order; ++order) {
      grow({.order = order, .children = {}}, order - 1, 0, meagre);
      for (int u = 0, n = static_cast<int>(fat.size()); u < n; ++u)
        grow({.order = order, .children = {}, .multiplier = u}, order - 1 - fat[u].order, 0, meagre);
      if (order > 1) grow({.order = order - 1, .children = {}}, order, 0, fat);
    }
    for (Tree& tree : meagre) {
      char last = 'i';
      tree.text = "Σ b_i";
      write(tree, 'i', last, tree.text);
    }
  }

 private:
  // Adds children with together `rest` vertices, from meagre[from] on, in all ways.
  void grow(Tree tree, int rest, int from, std::vector<Tree>& kind) {
    if (rest == 0) return finish(std::move(tree), kind);
    for (int t = from, n = static_cast<int>(meagre.size()); t < n && meagre[t].order <= rest; ++t) {
      tree.children.push_back(t);
      grow(tree, rest - meagre[t].order, t, kind);
      tree.children.pop_back();
    }
  }

  void finish(Tree tree, std::vector<Tree>& kind) {
    const bool is_fat = &kind == &fat, has_fat = tree.multiplier >= 0;
    if (has_fat && tree.children.empty()) return;
    const auto by_v =
        std::count_if(tree.children.begin(), tree.children.end(), [&](int t) { return !meagre[t].position; });
    if ((has_fat && by_v > 0) || (is_fat && by_v > 1)) return;
    tree.position = !has_fat && by_v <= 1;
    tree.constrained = is_fat;
    (is_fat ? tree.over : tree.under) = is_fat ? tree.order + 1 : tree.order;
    for (int t : tree.children) multiply(tree, meagre[t]);
    if (has_fat) multiply(tree, fat[tree.multiplier]);
    kind.push_back(std::move(tree));
  }

  static void multiply(Tree& tree, const Tree& child) {
    tree.constrained |= child.constrained;
    tree.over *= child.over;
    tree.under *= child.under;
    const int common = std::gcd(tree.over, tree.under);
    tree.over /= common;
    tree.under /= common;
  }

  void write(const Tree& tree, char at, char& last, std::string& text) const {
    auto factor = [&](const char* name, const Tree& child) {
      const char to = ++last;
      text += name;
      text += at;
      text += to;
      write(child, to, last, text);
    };
    const auto leaves = std::count(tree.children.begin(), tree.children.end(), 0);
    if (leaves > 0) (text += " c_") += at;
    if (leaves > 1) (text += '^') += std::to_string(leaves);
    for (int t : tree.children)
      if (t > 0) factor(" a_", meagre[t]);
    if (tree.multiplier >= 0) factor(" ω_", fat[tree.multiplier]);
  }
};

const Trees& trees() {
  static const Trees all;
  return all;
}

// Σ b_i φ_i of every meagre tree. A subtree's sums stand in a row, for each row l of the tableau or stage k.
Vec sums(const Matrix& A, const Matrix& inverse) {
  const auto& [meagre, fat] = trees();
  const Eigen::Index n = A.rows();
  Matrix rows = Matrix::Zero(meagre.size(), n + 1);  // Σ_k a_lk φ_k, l = 0...s+1
  Matrix multipliers(fat.size(), n);                 // Σ_l ω_kl (product of the children)_l, k = 0...s
  auto children = [&](const Tree& tree) {
    Vec product = Vec::Ones(n + 1);
    for (int t : tree.children) product.array() *= rows.row(t).transpose().array();
    return product;
  };
  int known = 0;
  for (std::size_t t = 0; t < meagre.size(); ++t) {
    Vec phi = children(meagre[t]).head(n);
    if (const int u = meagre[t].multiplier; u >= 0) {
      for (; known <= u; ++known) multipliers.row(known) = inverse * children(fat[known]).tail(n);
      phi.array() *= multipliers.row(u).transpose().array();
    }
    rows.row(t).tail(n) = A * phi;
  }
  return rows.col(n);
}

// The first order whose conditions do not all hold, less one; its first such condition in `broken`.
int order_among(const std::vector<OrderCondition>& conditions, bool constrained,
                const OrderCondition** broken) {
  for (const OrderCondition& condition : conditions)
    if ((constrained || !condition.constrained) && !condition.holds()) {
      *broken = &condition;
      return condition.order - 1;
    }
  return highest_order;
}

bool every_multiplier_acts(const Tableau& tableau) { return (tableau.Av.diagonal().array() != 0.0).all(); }

}  // namespace

bool OrderCondition::holds() const {
  return std::abs(value - static_cast<double>(over) / under) <= std::min(1e-11 * terms, 1e-6);
}

std::vector<OrderCondition> order_conditions(const Tableau& tableau) {
  const Matrix& A = tableau.Av;
  auto is_it = [&](const Matrix& B) { return B.rows() == A.rows() && B.cols() == A.cols() && B == A; };
  if (A.rows() != A.cols() || !is_it(tableau.Ac) || !is_it(tableau.Aq))
    throw std::invalid_argument("tableau '" + tableau.name + "': order conditions need square Ac = Av = Aq");
  const bool constrained = every_multiplier_acts(tableau);
  Matrix inverse = Matrix::Identity(A.rows(), A.cols());
  if (constrained) A.triangularView<Eigen::Lower>().solveInPlace(inverse);
  const Vec value = sums(A, inverse), terms = sums(A.cwiseAbs(), inverse.cwiseAbs());
  std::vector<OrderCondition> conditions;
  int t = 0;
  for (const Tree& tree : trees().meagre) {
    if (constrained || !tree.constrained)
      conditions.push_back(
          {tree.text, tree.order, tree.constrained, value[t], terms[t], tree.over, tree.under});
    ++t;
  }
  return conditions;
}

TableauOrder order_of(const Tableau& tableau) {
  const auto conditions = order_conditions(tableau);
  const OrderCondition* broken = nullptr;
  return {order_among(conditions, false, &broken),
          every_multiplier_acts(tableau) ? order_among(conditions, true, &broken) : 0};
}

void require_order(const Tableau& tableau, TableauOrder claimed) {
  const auto conditions = order_conditions(tableau);
  auto check = [&](int order, bool constrained) {
    auto refuse = [&](const std::string& reason) {
      throw std::invalid_argument("tableau '" + tableau.name + "': order " + std::to_string(order) +
                                  (constrained ? " with multipliers" : "") + " claimed, but " + reason);
    };
    if (order > highest_order) refuse("conditions are known up to order " + std::to_string(highest_order));
    if (constrained && order > 0 && !every_multiplier_acts(tableau)) refuse("some a_{l,l-1} is 0");
    const OrderCondition* broken = nullptr;
    if (order_among(conditions, constrained, &broken) >= order) return;
    char sum[64];
    std::snprintf(sum, sizeof sum, " = %.15g, must be %d", broken->value, broken->over);
    std::string why = std::string(broken->text) + sum;
    if (broken->under > 1) (why += '/') += std::to_string(broken->under);
    refuse(broken->constrained ? why + ", where (ω) is the inverse of (a)" : why);
  };
  check(claimed.free, false);
  check(claimed.constrained, true);
}

}  // namespace saltus


#include "sim/core/error.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/skin/elastic_contact.h"

namespace slipbench {
namespace {

ElasticBody body_of(const Parameters& p) { return {p.number("shear_modulus"), p.number("thickness")}; }

class ElasticSkin final : public SkinEffect {
 public:
  ElasticSkin(const Parameters& p, const PadLayout& layout)
      : contact_(make_influence(layout, body_of(p), p.number("patch")), layout.elements.size(), p.number("tolerance")),
        n_(layout.elements.size()) {
    find_punch();
  }

  void press(const double* gap) override { contact_.press(Eigen::Map<const Eigen::ArrayXd>(gap, rows())); }
  void shear(const double* target_x, const double* target_y, const double* limit) override {
    target_.col(0) = Eigen::Map<const Eigen::ArrayXd>(target_x, rows());
    target_.col(1) = Eigen::Map<const Eigen::ArrayXd>(target_y, rows());
    contact_.shear(target_, Eigen::Map<const Eigen::ArrayXd>(limit, rows()));
  }
  [[nodiscard]] Solution solution() override {
    ElasticContact& c = contact_;
    return {c.pressure().data(), c.sunk().data(),         c.friction().data(), c.friction().col(1).data(),
            c.shift().data(),    c.shift().col(1).data(), c.slides().data()};
  }
  [[nodiscard]] double own_normal() const override { return contact_.influence().own_normal(); }
  [[nodiscard]] double own_tangential() const override { return contact_.influence().own_tangential(); }
  [[nodiscard]] std::span<const double> punch_normal() const override { return punch_normal_; }
  [[nodiscard]] std::span<const double> punch_tangential() const override { return punch_tangential_; }
  [[nodiscard]] std::span<double> memory() override { return contact_.memory(); }

 private:
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(n_); }

  // Finds the forces of a face that presses all elements by 1 m, and of one that sticks to all and
  // moves by 1 m.
  void find_punch() {
    contact_.press(Eigen::ArrayXd::Constant(rows(), -1.0));
    punch_normal_.assign(contact_.pressure().begin(), contact_.pressure().end());
    const double most = contact_.pressure().sum();  // above the force of any element
    target_.resize(rows(), 2);
    target_.col(0).setOnes();
    target_.col(1).setZero();
    contact_.shear(target_, Eigen::ArrayXd::Constant(rows(), most));
    punch_tangential_.assign(contact_.friction().col(0).begin(), contact_.friction().col(0).end());
    std::ranges::fill(contact_.memory(), 0.0);
  }

  ElasticContact contact_;
  std::size_t n_;
  Eigen::ArrayX2d target_;
  std::vector<double> punch_normal_, punch_tangential_;  // N/m
};

}  // namespace

EffectKind elastic_skin() {
  return {
      {"elastic_skin",
       "The pad is one elastic body: a load also deforms its surroundings, and slip starts where friction is lowest and spreads.",
       "w = C p, u = C q: how far the surface is pressed in and sheared under normal and tangential forces of all elements\n"
       "p >= 0, gap + w >= 0, p (gap + w) = 0; |q| <= mu p; slip along q where |q| = mu p\n"
       "C: an incompressible half-space (thickness inf: Boussinesq, Cerruti) or layer on a rigid back, each element's load spread over its cell.\n"
       "It replaces the sensor's stiffness. The touched face is rigid and its slopes are small.\n"
       "The coupling of normal and tangential load is left out; it is zero for a half-space.",
       "K. L. Johnson, Contact Mechanics (1985), ch. 3 to 5 and 7; J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990)",
       {number_spec("shear_modulus", Quantity::pressure, "0.15 MPa", {1.0, 1e12}, "Shear modulus G; Young's modulus is 3 G.",
                    "assumed: silicone gel of Shore A 15"),
        number_spec("thickness", Quantity::length, "inf", positive_or_infinite,
                    "Thickness of the layer on its rigid back; inf: a half-space. A layer needs elements on a regular grid.",
                    "set for each scene"),
        number_spec(
            "patch", Quantity::length, "0 mm", non_negative,
            "Edge of the square that each element represents if the elements are not on a regular grid; 0: their mean distance.",
            "geometry"),
        number_spec("tolerance", Quantity::none, "0.0001", {1e-10, 1e-2},
                    "Residual at which the solver stops, as a share of the largest depth and of the largest friction.",
                    "error of a force below 0.01 % of the load: tests/oracle")}},
      {Change::normal_force},
      [](const Parameters& p, const EffectContext& context, FieldEffects& effects) {
        if (effects.skin) throw SceneValueError("effects", "elastic_skin is listed twice");
        if (context.dashpots) {
          throw SceneValueError(
              "effects", "elastic_skin replaces the sensor's springs, so the sensor must not have dashpots; set damping to 0");
        }
        effects.skin = std::make_unique<ElasticSkin>(p, *context.layout);
      },
      false,
      {"FFTW"},
      "tolerance",
      {},
      body_of};
}

}  // namespace slipbench

#include "saltus/kernel/model/plugin_model.hpp"
#include "slider_crank/slider_crank.hpp"

namespace {

saltus::NonSmoothDynamicalSystem slider_crank() {
  return saltus::examples::make_slider_crank(saltus::examples::Guidance::frictional);
}

}  // namespace

SALTUS_MODEL(slider_crank);

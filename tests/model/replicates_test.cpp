// SPDX-License-Identifier: Apache-2.0
// The sigma of what is computed from a lamp with replicates: with all that its texels share.
#include "formats/model/intensity_sigma.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "tests/support/lamps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield::model {
namespace {

constexpr Receiver kReceiver{{0.02, -0.03, 1.5}, {0, 0, -1}};

// A lamp whose replicates are brighter and darker by 1 % as a whole.
LightField lamp_with_common_error() {
    LightField lamp;
    lamp.slabs = {support::random_lamp(make_profile("bspline"), Weighting::Irradiance, 3)};
    Slab& slab = lamp.slabs.front();
    slab.sigma.assign(slab.coeffs.size(), 1e-9F);
    for (const float factor : {0.99F, 1.01F, 1.01F, 0.99F}) {
        slab.replicates.push_back(slab.coeffs);
        for (float& coefficient : slab.replicates.back())
            coefficient *= factor;
    }
    return lamp;
}

// Proves that an error which all texels share does not average out, as independent ones would.
TEST(Replicates, KnowWhatTexelsShare) {
    LightField lamp = lamp_with_common_error();
    const double lux = luminance(irradiance(lamp, kReceiver));
    ASSERT_GT(lux, 0.0);
    EXPECT_NEAR(irradiance_sigma_y(lamp, kReceiver) / lux, 0.01, 1e-6);
    EXPECT_NEAR(flux_sigma_y(lamp) / luminance(flux(lamp)), 0.01, 1e-6);
    const glm::dvec3 ahead{0.01, -0.02, 1.0};
    EXPECT_NEAR(intensity_sigma_y(lamp, ahead) / luminance(intensity(lamp, ahead)), 0.01, 1e-6);
    lamp.scale_sigma_rel = 0.02;
    EXPECT_NEAR(irradiance_sigma_y(lamp, kReceiver) / lux, std::hypot(0.01, 0.02), 1e-6);
    EXPECT_NEAR(flux_sigma_y(lamp) / luminance(flux(lamp)), 0.01, 1e-6);
}

// Proves that what replicates say stands in place of the coefficients' sigma, and that a shift of
// all of them to one side is part of it.
TEST(Replicates, ShiftsCountToo) {
    LightField lamp = lamp_with_common_error();
    Slab& slab = lamp.slabs.front();
    const std::vector<float> brighter = slab.replicates[1];
    slab.replicates.assign(3, brighter);
    const double lux = luminance(irradiance(lamp, kReceiver));
    EXPECT_NEAR(irradiance_sigma_y(lamp, kReceiver) / lux, 0.01, 1e-6);
}

}  // namespace
}  // namespace nearfield::model

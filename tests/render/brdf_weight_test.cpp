// SPDX-License-Identifier: Apache-2.0
#include "formats/shared/brdf_weight.glsl.h"
#include "tests/render/brdf_oracle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nearfield {
namespace {

// Proves the shortened form against what it is short for, direction by direction, where float lets
// that be divided at all; and finite numbers >= 0 everywhere.
TEST(BrdfWeight, IsLobeTimesCosineOverDensity) {
    support::Random random{5};
    int compared = 0;
    for (const test::LobeCase& lobe : test::lobe_cases())
        for (const double angle : {0.0, 0.5, 1.0, 1.4})
            for (int k = 0; k < 500; ++k) {
                const glm::vec3 v = test::viewer_at(angle);
                const glm::vec3 l =
                    shared::brdf_lobe_sample(lobe.brdf, v, test::random_pair(random));
                const float weight = shared::brdf_lobe_weight(lobe.brdf, l, v).y;
                EXPECT_TRUE(std::isfinite(weight) && weight >= 0.0F) << lobe.name;
                const float density = shared::brdf_lobe_density(lobe.brdf, l, v);
                if (!(density > 1e-3F && l.z > 1e-2F))
                    continue;
                EXPECT_NEAR(shared::brdf_lobe(lobe.brdf, l, v).y * l.z / density / weight, 1.0F,
                            2e-3F)
                    << lobe.name << ", viewer " << angle << ", light " << l.z;
                ++compared;
            }
    EXPECT_GT(compared, 10000);
}

}  // namespace
}  // namespace nearfield

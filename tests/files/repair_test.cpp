// SPDX-License-Identifier: Apache-2.0
// Proves that values which no reader accepts can be read to be repaired, that every one of them is
// repaired as documented and counted, and that nothing else changes.
#include "formats/files/repair.h"

#include "formats/files/error.h"
#include "formats/files/exr_file.h"
#include "formats/files/lightfield_parts.h"
#include "tests/files/sample_lightfield.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace nearfield::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// One slab of 3 x 2 images of 5 x 4 texels, R G B, with sigma.
LightField valid_lightfield() {
    LightField lightfield;
    lightfield.slabs.push_back(sample_slab({{3, 2}, {5, 4}, 3, true}));
    return lightfield;
}

// Each kind of bad value in coefficients, negative ones in sigma too.
LightField broken_lightfield() {
    LightField lightfield = valid_lightfield();
    Slab& slab = lightfield.slabs[0];
    slab.coeffs[0] = kNan;
    slab.coeffs[1] = -kNan;
    slab.coeffs[7] = -1e-30F;
    slab.coeffs[8] = -kInfinity;
    slab.coeffs[slab.image_offset(2, 5) + 3] = kInfinity;
    slab.sigma[4] = -2.0F;
    return lightfield;
}

void write_broken(const LightField& lightfield, const std::string& path) {
    exr::write(lightfield_atlases(lightfield), exr::Compression::Zip,
               {{kLuminaireAttribute, describe(lightfield, {"lightfield", kFormatVersion}, false)}},
               path);
}

TEST(Repair, ChangesAndCountsWhatReadersRefuseAndNothingElse) {
    write_broken(broken_lightfield(), "broken.lightfield.exr");
    EXPECT_THROW(read_lightfield("broken.lightfield.exr"), Error);
    LightField repaired = read_broken_lightfield("broken.lightfield.exr");
    EXPECT_EQ(repair(repaired), (Repairs{3, 2, 1}));
    check(repaired, "repaired");

    const Slab valid = valid_lightfield().slabs[0];
    Slab& slab = repaired.slabs[0];
    const std::size_t infinite = slab.image_offset(2, 5) + 3;
    float largest = 0.0F;
    for (std::size_t k = slab.image_offset(2, 5); k < slab.coeffs.size(); ++k)
        largest = k == infinite ? largest : std::max(largest, valid.coeffs[k]);
    EXPECT_EQ(slab.coeffs[infinite], largest);
    slab.coeffs[infinite] = valid.coeffs[infinite];
    for (const std::size_t k : {0, 1, 7, 8}) {
        EXPECT_EQ(slab.coeffs[k], 0.0F);
        slab.coeffs[k] = valid.coeffs[k];
    }
    EXPECT_EQ(slab.sigma[4], 0.0F);
    slab.sigma[4] = valid.sigma[4];
    EXPECT_EQ(slab.coeffs, valid.coeffs);
    EXPECT_EQ(slab.sigma, valid.sigma);
}

TEST(Repair, LeavesAValidLightFieldAsItIs) {
    LightField lightfield = valid_lightfield();
    EXPECT_EQ(repair(lightfield).count(), 0U);
    EXPECT_EQ(lightfield.slabs[0].coeffs, valid_lightfield().slabs[0].coeffs);
}

// An image without any finite light has no largest: its infinite texels become dark.
TEST(Repair, DarkensAnImageOfInfiniteTexelsAlone) {
    LightField lightfield = valid_lightfield();
    Slab& slab = lightfield.slabs[0];
    std::fill(slab.coeffs.begin(),
              slab.coeffs.begin() + static_cast<std::ptrdiff_t>(slab.texel_count()), kInfinity);
    EXPECT_EQ(repair(lightfield).infinite, slab.texel_count());
    EXPECT_EQ(slab.coeffs[0], 0.0F);
    check(lightfield, "repaired");
}

}  // namespace
}  // namespace nearfield::test

// SPDX-License-Identifier: Apache-2.0
// The photometry of a light field has the light field's intensity and flux, and is written.
#include "formats/photometry/of_lightfield.h"

#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "formats/photometry/intensity.h"
#include "formats/photometry/photometric_file.h"
#include "formats/photometry/to_lightfield.h"
#include "tests/photometry/lamp_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace nearfield {
namespace {

using photometry::Angles;
using photometry::Photometry;

// One texel and one cell, both tiny: a beam along the ray from (0, 0) on U to (3, -1) on S before
// it.
LightField pencil() {
    Slab slab;
    slab.delta_m = 2;
    slab.grid = {1, 1};
    slab.pitch_m = {1e-2, 2e-2};
    slab.texels = {1, 1};
    slab.s_min_m = {2.9, -1.1};
    slab.s_max_m = {3.1, -0.9};
    slab.profile = model::make_profile("box");
    slab.coeffs = {5e5F};
    LightField lightfield;
    lightfield.slabs = {slab};
    return lightfield;
}

// C counts from +x to -y: the beam is in the plane atan(1 / 3) = 18.4 degrees, atan(sqrt(10) / 2) =
// 57.7 degrees from the axis.
TEST(OfLightField, PointsWhereTheLightGoes) {
    const LightField beam = pencil();
    const Photometry lamp = photometry::photometry_of(beam, {360, 180});
    const Angles at = photometry::peak(lamp).angles;
    EXPECT_NEAR(at.plane_deg, std::atan2(1, 3) * 180 / std::numbers::pi, 2.5);
    EXPECT_NEAR(at.angle_deg, std::atan2(std::sqrt(10), 2) * 180 / std::numbers::pi, 2.5);
    EXPECT_EQ(lamp.opening.size_m, glm::dvec3(1e-2, 2e-2, 0));
    EXPECT_EQ(lamp.angles_deg.back(), 90);
}

// Back and forth: the table is the light field's intensity to the bit, its flux that of the light
// field (a bilinear table errs by steps squared: (1 degree)^2), and both formats keep it.
TEST(OfLightField, KeepsIntensityAndFlux) {
    Photometry lamp = photometry::read_photometry(
        test::write_text("skew.ies", to_text(test::skew_lm63(photometry::Coordinates::C, 2))));
    lamp.opening = {photometry::Shape::Rectangle, {0.3, 0.2, 0}, {}};
    photometry::LightFieldOptions options;
    options.slabs = 1;
    options.texels = 128;
    const auto far = photometry::to_lightfield(lamp, options);
    const Photometry again = photometry::photometry_of(far.lightfield, {360, 180});
    EXPECT_NEAR(photometry::flux_lm(again), far.lightfield_lm, 1e-3 * far.lightfield_lm);
    EXPECT_EQ(again.lamps[0].flux_lm, far.lightfield_lm);
    for (const double plane : {0.0, 77.0, 200.0, 360.0})
        for (const double angle : {0.0, 20.0, 60.0}) {
            const glm::dvec3 d =
                photometry::direction_of(photometry::Coordinates::C, {plane, angle});
            const double there = photometry::intensity_cd(again, Angles{plane, angle});
            EXPECT_NEAR(there, model::intensity(far.lightfield, d).y, 1e-9 * there);
            EXPECT_NEAR(there, photometry::intensity_cd(lamp, d), 0.01 * there);
        }
    for (const auto format : {photometry::FileFormat::Lm63, photometry::FileFormat::Eulumdat}) {
        photometry::write_photometry(again, format, "lightfield.txt");
        const Photometry written = photometry::read_photometry("lightfield.txt");
        EXPECT_TRUE(written.is_absolute);
        EXPECT_NEAR(photometry::flux_lm(written), photometry::flux_lm(again), 1e-6);
    }
}

TEST(OfLightField, RefusesWattsAndBadTables) {
    LightField beam = pencil();
    EXPECT_THROW(photometry::photometry_of(beam, {6, 90}), Error);
    EXPECT_THROW(photometry::photometry_of(beam, {72, 1}), Error);
    beam.quantity = Quantity::Radiometric;
    EXPECT_THROW(photometry::photometry_of(beam), Error);
}

}  // namespace
}  // namespace nearfield

// SPDX-License-Identifier: Apache-2.0
// What samplers promise one receiver: energies, densities, inverses. Statistics of many:
// estimators_*.
#include "formats/model/sampler.h"

#include "formats/model/sampler_draws.h"
#include "formats/model/sampler_window.h"
#include "tests/support/lamps.h"
#include "tests/support/oracle.h"
#include "tests/support/random.h"
#include "tests/support/receivers.h"
#include "tests/support/window_energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace nearfield::model {
namespace {

using support::axis_parts;
using support::AxisPart;
using support::hard_receivers;
using support::HardReceiver;
using support::Random;
using support::random_lamp;

constexpr Sampler kSamplers[] = {Sampler::Uniform, Sampler::Precomputed, Sampler::Pdis,
                                 Sampler::Systematic, Sampler::Cells};

ReceiverF in_float(const Receiver& receiver) {
    return {glm::vec3(receiver.position_m), glm::vec3(receiver.normal)};
}

SamplerOptions options_of(Sampler sampler, int samples = 64) {
    SamplerOptions options;
    options.sampler = sampler;
    options.samples = samples;
    options.sequence = default_sequence(sampler);
    return options;
}

/// One receiver's view, drawn from once so that Pdis knows its counts.
struct Looked {
    std::vector<SamplingSlab> slabs;
    std::vector<SamplingView> views{1};
    SamplerOptions options;
    std::vector<LightSample> samples;

    Looked(const Slab& lamp, const ReceiverF& receiver, const SamplerOptions& with)
        : options(with) {
        slabs.push_back(prepare_sampling(lamp));
        look_from(receiver);
    }
    void look_from(const ReceiverF& receiver) {
        look(slabs[0], receiver, options, views[0]);
        draw(slabs, views, options, {0.3F, 0.8F}, samples);
    }
};

// Energies against sums over texels in double, each cut by the box on its own: every height, both
// weightings. The box' corners are rounded to float: 1e-5 of a texel's width, wherever it lies.
TEST(Sampler, EnergiesAreSumsOverTexels) {
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance})
        for (const Profile& profile : support::all_profiles()) {
            const Slab lamp = random_lamp(profile, weighting, 3);
            Looked looked(lamp, {}, options_of(Sampler::Systematic));
            for (const double height : support::kHardHeights)
                for (const HardReceiver& hard : hard_receivers(lamp, height, 11)) {
                    const ReceiverF receiver = in_float(hard.receiver);
                    looked.look_from(receiver);
                    double sum = 0.0;
                    for (const float energy : looked.views[0].energy)
                        sum += static_cast<double>(energy);
                    double expected = 0.0;
                    for (int m = 0; m < lamp.image_count(); ++m)
                        expected += support::support_energy(lamp, receiver, m);
                    if (hard.kind == support::ReceiverKind::Back ||
                        hard.kind == support::ReceiverKind::Beside)
                        expected = 0.0;
                    else if (looked.views[0].total == 0.0F)
                        continue;  // nothing of what it sees faces it
                    EXPECT_NEAR(sum, expected, 1e-4 * expected)
                        << profile.name << ", " << hard.name;
                }
        }
}

// Cells' energies against the same sums, cell by cell, times Phi's mean there.
TEST(Sampler, CellEnergiesAreSumsOverTexels) {
    for (const Profile& profile : support::all_profiles()) {
        const Slab lamp = random_lamp(profile, Weighting::Irradiance, 5);
        const auto n = static_cast<int>(profile.cells.size());
        Looked looked(lamp, {}, options_of(Sampler::Cells));
        for (const double height : {-0.9, -0.3, 0.0, 0.01, 0.7, 40.0}) {
            const ReceiverF receiver = in_float(hard_receivers(lamp, height, 12)[0].receiver);
            looked.look_from(receiver);
            double largest = 0.0;
            for (const float energy : looked.views[0].energy)
                largest = std::max(largest, static_cast<double>(energy));
            for (int m = 0; m < lamp.image_count(); ++m)
                for (int c = 0; c < n * n; ++c) {
                    const double expected = support::cell_energy(lamp, receiver, m, {c % n, c / n});
                    const auto at = static_cast<std::size_t>(m * n * n + c);
                    EXPECT_NEAR(static_cast<double>(looked.views[0].energy[at]), expected,
                                1e-4 * expected + 1e-5 * largest)
                        << profile.name << " at " << height << ", image " << m << ", cell " << c;
                }
        }
    }
}

// The sum over images of the integral of the joint density is 1 for every sampler. The density is
// constant between the edges of texels, seen from the receiver, and of cells: the middle of every
// piece times its area is exact. As printed Pdis loses the samples in columns that are lit outside
// the box alone: on a lamp with dark texels its integral is below 1, by those.
TEST(Sampler, JointDensitiesIntegrateToOne) {
    const Slab with_dark_texels = random_lamp(support::all_profiles()[3], Weighting::Irradiance, 7);
    const Slab lit =
        random_lamp(support::all_profiles()[3], Weighting::Irradiance, 7, {.dark_fraction = 0.0});
    for (const Sampler sampler : kSamplers) {
        const Slab& lamp = sampler == Sampler::Pdis ? lit : with_dark_texels;
        Looked looked(lamp, {}, options_of(sampler));
        for (const double height : {-0.7, -0.2, 0.3, 2.0}) {
            const ReceiverF receiver = in_float(hard_receivers(lamp, height, 13)[0].receiver);
            looked.look_from(receiver);
            const SamplingView& view = looked.views[0];
            const auto x = axis_parts(lamp, receiver, 0), y = axis_parts(lamp, receiver, 1);
            double sum = 0.0;
            for (const AxisPart& px : x)
                for (const AxisPart& py : y) {
                    const glm::vec2 u(px.middle_u_m(), py.middle_u_m());
                    double joint = 0.0;
                    for (int m = 0; m < lamp.image_count(); ++m)
                        joint += static_cast<double>(joint_density_u(
                            looked.slabs[0], view, looked.options, view.total, m, u));
                    EXPECT_NEAR(static_cast<double>(marginal_density_u(
                                    looked.slabs[0], view, looked.options, view.total, u)),
                                joint, 1e-5 * joint)
                        << name_of(sampler);
                    sum += joint * px.width_u_m() * py.width_u_m();
                }
            EXPECT_NEAR(sum, 1.0, 1e-3) << name_of(sampler) << " at " << height << " delta";
        }
    }
}

/// Solid angle of a triangle seen from the origin (Van Oosterom and Strackee, 1983).
double solid_angle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    return 2.0 * std::atan2(std::abs(glm::dot(a, glm::cross(b, c))),
                            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la +
                                glm::dot(c, a) * lb);
}

// Density per solid angle times a small square's solid angle is density per area times its area.
TEST(Sampler, DensityPerSolidAngleCountsTheSameSamples) {
    const Slab lamp = random_lamp(support::all_profiles()[3], Weighting::Irradiance, 8);
    Looked looked(lamp, {}, options_of(Sampler::Systematic));
    int lit = 0;
    for (const double height : {-0.7, 0.3, 2.0}) {
        const ReceiverF receiver = in_float(hard_receivers(lamp, height, 14)[0].receiver);
        looked.look_from(receiver);
        const SamplingView& view = looked.views[0];
        for (const LightSample& sample : looked.samples) {
            const glm::dvec3 u =
                glm::dvec3(glm::dvec2(sample.u_m), -lamp.delta_m) - glm::dvec3(receiver.position_m);
            const double h = 1e-4 * lamp.delta_m;
            const glm::dvec3 corner[] = {u + glm::dvec3(-h, -h, 0), u + glm::dvec3(h, -h, 0),
                                         u + glm::dvec3(h, h, 0), u + glm::dvec3(-h, h, 0)};
            const double omega = solid_angle(corner[0], corner[1], corner[2]) +
                                 solid_angle(corner[0], corner[2], corner[3]);
            const double per_area = static_cast<double>(
                marginal_density_u(looked.slabs[0], view, looked.options, view.total, sample.u_m));
            const double per_angle = static_cast<double>(marginal_density_omega(
                looked.slabs[0], view, looked.options, view.total, sample.u_m));
            EXPECT_NEAR(per_angle * omega, per_area * 4.0 * h * h, 1e-4 * per_angle * omega);
            ++lit;
        }
    }
    EXPECT_GT(lit, 100);
}

// sample(inverse(u)) = u and inverse(sample(xi)) = xi, of images and of cells.
TEST(Sampler, InverseUndoesSampling) {
    for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells}) {
        const Slab lamp = random_lamp(support::all_profiles()[3], Weighting::Irradiance, 9);
        const auto n = static_cast<int>(lamp.profile.cells.size());
        Looked looked(lamp, {}, options_of(sampler));
        Random random{1};
        for (const double height : {-0.9, -0.4, -1e-3, 1e-3, 0.3, 30.0}) {
            const ReceiverF receiver = in_float(hard_receivers(lamp, height, 15)[0].receiver);
            looked.look_from(receiver);
            SamplingView& view = looked.views[0];
            for (int trial = 0; trial < 300; ++trial) {
                const int m = static_cast<int>(random.uniform(0.0, lamp.image_count()));
                const bool by_cells = sampler == Sampler::Cells;
                const int cx = by_cells ? static_cast<int>(random.uniform(0.0, n)) : 0;
                const int cy = by_cells ? static_cast<int>(random.uniform(0.0, n)) : 0;
                const Window window =
                    open_window(looked.slabs[0], view, TablePrecision::Pair, m,
                                view.x[static_cast<std::size_t>(m % lamp.grid.x + cx)],
                                view.y[static_cast<std::size_t>(m / lamp.grid.x + cy)]);
                const glm::vec2 xi(static_cast<float>(random.uniform()),
                                   static_cast<float>(random.uniform()));
                const auto point = pick_point(looked.slabs[0], view, window, xi);
                if (!point)
                    continue;
                const glm::vec2 u = aperture_point(view, window.x, window.y, *point).u_m;
                const glm::vec2 back = inverse_u(looked.slabs[0], view, looked.options, m, u);
                // u is rounded: by 1e-7 of S, up to 1e-3 of a texel that is narrow on U.
                EXPECT_NEAR(back.x, xi.x, 2e-3) << name_of(sampler) << " at " << height;
                EXPECT_NEAR(back.y, xi.y, 2e-3) << name_of(sampler) << " at " << height;
            }
        }
    }
}

/// How far a point is from the nearest of a sequence's first `count`, along the axis where it is
/// farther.
float distance_to_nearest(glm::vec2 point, Sequence sequence, int count, glm::vec2 shift) {
    float nearest = 1.0F;
    for (int q = 0; q < count; ++q) {
        const glm::vec2 off =
            glm::abs(point - plane_point(sequence, static_cast<std::uint32_t>(q),
                                         static_cast<std::uint32_t>(count), shift));
        nearest = std::min(nearest, std::max(off.x, off.y));
    }
    return nearest;
}

// The baselines' points come from a plane sequence that is known: each drawn point inverts to one
// of its image's. Points without light are left out of the samples, so which one is not known.
TEST(Sampler, InverseFindsTheBaselinesCoordinates) {
    const Slab lamp = random_lamp(support::all_profiles()[3], Weighting::Irradiance, 9);
    constexpr glm::vec2 kShift(0.37F, 0.81F);
    for (const Sampler sampler : {Sampler::Uniform, Sampler::Pdis, Sampler::Precomputed}) {
        // Few points of a whole image are in sight.
        const SamplerOptions options =
            options_of(sampler, sampler == Sampler::Precomputed ? 2000 : 200);
        Looked looked(lamp, {}, options);
        std::size_t inverted = 0;
        const SamplingView& view = looked.views[0];
        const auto points_of = [&](int image) {
            const float energy = view.energy[static_cast<std::size_t>(image)];
            return sampler == Sampler::Uniform ? static_cast<int>(view.drawn / view.total)
                   : sampler == Sampler::Pdis  ? pdis_samples(options, view.total, energy)
                                               : options.samples;
        };
        for (const double height : {-0.4, 0.3, 30.0}) {
            looked.look_from(in_float(hard_receivers(lamp, height, 15)[0].receiver));
            draw(looked.slabs, looked.views, options, kShift, looked.samples);
            inverted += looked.samples.size();
            for (const LightSample& sample : looked.samples) {
                const glm::vec2 back =
                    inverse_u(looked.slabs[0], view, options, sample.image, sample.u_m);
                const float nearest =
                    distance_to_nearest(back, options.sequence, points_of(sample.image), kShift);
                EXPECT_LT(nearest, 2e-3F) << name_of(sampler) << " at " << height;
            }
        }
        EXPECT_GT(inverted, 20U) << name_of(sampler);
    }
}

// Against the sum over all images, by rays through points of U; 0 beside S and behind U.
TEST(Sampler, RadianceTowardsIsTheLightFields) {
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance}) {
        support::LampShape shape;
        shape.channels = 3;
        const Slab lamp = random_lamp(support::all_profiles()[4], weighting, 10, shape);
        const PreparedSlab prepared = prepare(lamp);
        Random random{2};
        int lit = 0;
        for (int trial = 0; trial < 500; ++trial) {
            const glm::vec2 u(glm::dvec2(random.uniform(-0.06, 0.07), random.uniform(-0.06, 0.05)));
            const glm::vec3 p(glm::dvec3(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1),
                                         random.uniform(-0.15, 0.4)));
            const glm::dvec2 s = glm::dvec2(u) + (glm::dvec2(p) - glm::dvec2(u)) *
                                                     (lamp.delta_m / (lamp.delta_m + p.z));
            // Where rounding cannot put s into the texel beside.
            const glm::dvec2 part = glm::fract((s - lamp.s_min_m) / lamp.texel_m());
            if (glm::any(glm::lessThan(glm::abs(part - 0.5), glm::dvec2(0.49))) &&
                glm::all(glm::lessThan(glm::abs(part - 0.5), glm::dvec2(0.499)))) {
                const glm::dvec3 expected = support::oracle_radiance(lamp, u, s);
                const glm::dvec3 got(radiance_towards(prepared, p, u));
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(got[c], expected[c], 2e-4 * expected[c]);
                lit += expected.y > 0.0 ? 1 : 0;
            }
        }
        EXPECT_GT(lit, 200);
        EXPECT_EQ(radiance_towards(prepared, {0.0F, 0.0F, -0.2F}, glm::vec2(0.0F)),
                  glm::vec3(0.0F));
        EXPECT_EQ(radiance_towards(prepared, {5.0F, 0.0F, 0.1F}, glm::vec2(0.0F)), glm::vec3(0.0F));
    }
}

/// No light from nowhere, never negative, never NaN, at hard receivers of one height.
void expect_sane_light(const Slab& lamp, Looked& looked, double height) {
    for (const HardReceiver& hard : hard_receivers(lamp, height, 16)) {
        looked.look_from(in_float(hard.receiver));
        for (const LightSample& sample : looked.samples)
            for (int c = 0; c < 3; ++c)
                ASSERT_TRUE(std::isfinite(sample.light[c]) && sample.light[c] >= 0.0F)
                    << name_of(looked.options.sampler) << ", " << hard.name;
        if (hard.kind == support::ReceiverKind::Back ||
            hard.kind == support::ReceiverKind::Beside) {
            EXPECT_TRUE(looked.samples.empty())
                << name_of(looked.options.sampler) << ", " << hard.name;
        }
    }
}

// Every sampler, every hard receiver, in color; exactly nothing at U and behind it.
TEST(Sampler, HardReceiversGetFiniteLight) {
    support::LampShape shape;
    shape.channels = 3;
    for (const Weighting weighting : {Weighting::Irradiance, Weighting::Radiance}) {
        const Slab lamp = random_lamp(support::all_profiles()[3], weighting, 21, shape);
        for (const Sampler sampler : kSamplers) {
            Looked looked(lamp, {}, options_of(sampler));
            for (const double height : support::kHardHeights)
                expect_sane_light(lamp, looked, height);
            const auto delta_m = static_cast<float>(lamp.delta_m);
            for (const float below : {1.0F, 1.0001F, 5.0F}) {
                looked.look_from({{0.0F, 0.0F, -below * delta_m}, {0.0F, 0.0F, -1.0F}});
                EXPECT_EQ(looked.views[0].total, 0.0F);
                EXPECT_TRUE(looked.samples.empty());
            }
        }
    }
}

// Counts are as asked for: exactly K draws; Pdis at most K and a half an image; k_max an image.
TEST(Sampler, DrawsAsManyAsAsked) {
    const Slab lamp =
        random_lamp(support::all_profiles()[0], Weighting::Irradiance, 22, {.dark_fraction = 0.0});
    const ReceiverF receiver{{0.0F, 0.0F, 0.4F}, {0.0F, 0.0F, -1.0F}};
    for (const int k : {1, 2, 16, 63}) {
        for (const Sampler sampler : {Sampler::Systematic, Sampler::Cells}) {
            const Looked looked(lamp, receiver, options_of(sampler, k));
            EXPECT_EQ(looked.samples.size(), static_cast<std::size_t>(k)) << name_of(sampler);
        }
        const Looked pdis(lamp, receiver, options_of(Sampler::Pdis, k));
        EXPECT_LE(pdis.samples.size(), static_cast<std::size_t>(k + lamp.image_count() / 2));
        SamplerOptions capped = options_of(Sampler::Pdis, k);
        capped.k_max = 1;
        EXPECT_LE(Looked(lamp, receiver, capped).samples.size(),
                  static_cast<std::size_t>(lamp.image_count()));
    }
}

}  // namespace
}  // namespace nearfield::model

// SPDX-License-Identifier: Apache-2.0
// Reflected radiance by the sum with f_r, against quadrature in double of L f_r cos over the solid
// angle of U: radiance from the oracle, f_r from its own header (which has its own tests), cut at
// the edges of cells and texels. What the sum shares with it is f_r alone.
#include "formats/model/glossy_sum.h"

#include "formats/model/luminaire.h"
#include "formats/model/profile.h"
#include "tests/support/lamps.h"
#include "tests/support/oracle.h"
#include "tests/support/quadrature.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::model {
namespace {

using support::gauss_rule;
using support::GaussRule;
using support::LampShape;
using support::oracle_radiance;
using support::Random;
using support::random_lamp;

constexpr std::uint32_t kKinds[] = {shared::kBrdfPhong, shared::kBrdfGgx, shared::kBrdfWard,
                                    shared::kBrdfLafortune, shared::kBrdfHalfwayDisk};
constexpr Weighting kWeightings[] = {Weighting::Irradiance, Weighting::Radiance};

// Where the integrand is smooth along an axis of U: cells' edges and what the texels' edges are
// seen on.
std::vector<double> cuts_on_u(const Slab& slab, int axis, glm::dvec3 p_m) {
    const auto n = static_cast<int>(slab.profile.cells.size());
    const double first_m = slab.basis_center_m(0, 0)[axis] - 0.5 * n * slab.pitch_m[axis];
    std::vector<double> cuts_m(static_cast<std::size_t>(slab.grid[axis] + n));
    for (std::size_t k = 0; k < cuts_m.size(); ++k)
        cuts_m[k] = first_m + static_cast<double>(k) * slab.pitch_m[axis];
    const double low_m = cuts_m.front(), high_m = cuts_m.back();
    for (int i = 0; i <= slab.texels[axis]; ++i) {
        const double s_m = slab.s_min_m[axis] + i * slab.texel_m()[axis];
        const double u_m = s_m + (s_m - p_m[axis]) * slab.delta_m / p_m.z;
        if (u_m > low_m && u_m < high_m)
            cuts_m.push_back(u_m);
    }
    std::ranges::sort(cuts_m);
    return cuts_m;
}

// L f_r cos dw of a point u, per area on U.
glm::dvec3 integrand(const Slab& slab, const GlossyReceiver& receiver, glm::dvec2 u_m) {
    const glm::dvec3 p_m(receiver.position_m);
    const glm::dvec3 to_u_m = glm::dvec3(u_m, -slab.delta_m) - p_m;
    const double r_m = glm::length(to_u_m);
    const glm::dvec3 w = to_u_m / r_m;
    const glm::dvec3 local(glm::dot(w, glm::dvec3(receiver.frame.x)),
                           glm::dot(w, glm::dvec3(receiver.frame.y)),
                           glm::dot(w, glm::dvec3(receiver.frame.z)));
    if (local.z <= 0.0)
        return glm::dvec3(0.0);
    const glm::dvec2 s_m = u_m + (glm::dvec2(p_m) - u_m) * (slab.delta_m / (slab.delta_m + p_m.z));
    const glm::dvec3 f_r(
        shared::brdf_eval(receiver.brdf, glm::vec3(local), receiver.to_viewer_local));
    return oracle_radiance(slab, u_m, s_m) * f_r * (local.z * -w.z / (r_m * r_m));
}

glm::dvec3 reflected_by_quadrature(const Slab& slab, const GlossyReceiver& receiver, int order) {
    const GaussRule rule = gauss_rule(order);
    const glm::dvec3 p_m(receiver.position_m);
    const std::vector<double> x_m = cuts_on_u(slab, 0, p_m), y_m = cuts_on_u(slab, 1, p_m);
    glm::dvec3 sum(0.0);
    for (std::size_t b = 0; b + 1 < y_m.size(); ++b)
        for (std::size_t a = 0; a + 1 < x_m.size(); ++a) {
            const glm::dvec2 low_m(x_m[a], y_m[b]);
            const glm::dvec2 size_m = glm::dvec2(x_m[a + 1], y_m[b + 1]) - low_m;
            if (integrand(slab, receiver, low_m + 0.5 * size_m) == glm::dvec3(0.0))
                continue;  // dark, or missing S
            for (std::size_t j = 0; j < rule.node.size(); ++j)
                for (std::size_t i = 0; i < rule.node.size(); ++i)
                    sum += integrand(slab, receiver,
                                     low_m + size_m * glm::dvec2(rule.node[i], rule.node[j])) *
                           (rule.weight[i] * rule.weight[j] * size_m.x * size_m.y);
        }
    return sum;
}

// Roughness of a kind for which the narrowest width is as asked; across, half as rough again.
void set_width(GlossyReceiver& receiver, float width_rad) {
    float low = -8.0F, high = 8.0F;  // of the logarithm
    for (int step = 0; step < 40; ++step) {
        const float middle = 0.5F * (low + high);
        receiver.brdf.alpha = glm::vec2(1.0F, 1.5F) * std::exp(middle);
        receiver.brdf.exponent = std::exp(-2.0F * middle);
        const bool is_narrow =
            shared::brdf_lobe_width_rad(receiver.brdf, receiver.to_viewer_local) < width_rad;
        (is_narrow ? low : high) = middle;
    }
}

float texel_angle(const Slab& slab, float height_m) {
    return static_cast<float>(std::max(slab.texel_m().x, slab.texel_m().y)) / std::abs(height_m);
}

// A point lit by the middle of the lamp, and a viewer who sees a part of the aperture mirrored in
// it.
GlossyReceiver receiver_in_highlight(const Slab& slab, Random& random, double height_per_delta) {
    const glm::dvec2 aperture_m = slab.pitch_m * glm::dvec2(slab.grid);
    const auto on_u = [&] {
        const double x = random.uniform(-0.4, 0.4), y = random.uniform(-0.4, 0.4);
        return slab.u_center_m + aperture_m * glm::dvec2(x, y);
    };
    GlossyReceiver receiver;
    receiver.brdf.cosines = glm::vec3(-1.0F, -1.0F, 1.0F);
    do {
        const double x = random.uniform(-0.15, 0.15), y = random.uniform(-0.15, 0.15);
        const glm::dvec2 s_m =
            0.5 * (slab.s_min_m + slab.s_max_m) + (slab.s_max_m - slab.s_min_m) * glm::dvec2(x, y);
        const glm::dvec2 u_m = on_u(), beside_u_m = glm::mix(u_m, on_u(), 0.3);
        receiver.position_m =
            glm::vec3(s_m + (s_m - u_m) * height_per_delta, height_per_delta * slab.delta_m);
        const double cosine = random.uniform(0.5, 1.0), azimuth = random.uniform(0.0, 6.28);
        const double sine = std::sqrt(1.0 - cosine * cosine);
        receiver.frame = shared::frame_from_tangent(
            glm::vec3(sine * std::cos(azimuth), sine * std::sin(azimuth), -cosine),
            glm::vec3(0.8F, 0.6F, 0.1F));
        const glm::vec3 mirrored = shared::local_from_world(
            receiver.frame,
            glm::normalize(glm::vec3(glm::dvec3(beside_u_m, -slab.delta_m)) - receiver.position_m));
        receiver.to_viewer_local = {-mirrored.x, -mirrored.y, mirrored.z};
    } while (receiver.to_viewer_local.z < 0.2F);
    return receiver;
}

double relative_error(glm::dvec3 got, glm::dvec3 expected) {
    return glm::length(got - expected) / glm::length(expected);
}

// Proves the errors that the header states, for each kind of lobe, both weightings, from half a
// delta to ten. Lobes that a lamp's texels do not resolve are not its business.
TEST(GlossySum, ErrorIsAsStatedAtTheLimitAndFarFromIt) {
    LampShape shape;
    shape.decades = 1;
    shape.texels = {60, 50};  // windows of 4 texels and more
    struct Stated {
        float texels_per_width;
        double median, worst;
    };
    for (const Stated& stated : {Stated{1.0F, 1.2e-3, 5e-3}, Stated{0.5F, 2.5e-4, 1.6e-3}}) {
        std::vector<double> errors;
        for (const std::uint32_t kind : kKinds)
            for (const Weighting weighting : kWeightings) {
                const Slab slab = random_lamp(make_profile("bspline"), weighting, kind + 1, shape);
                const PreparedSlab prepared = prepare(slab);
                Random random{kind + 77};
                for (const double height_per_delta : {0.5, 0.8, 1.5, 2.5, 4.0, 10.0}) {
                    GlossyReceiver receiver = receiver_in_highlight(slab, random, height_per_delta);
                    receiver.brdf.kind = kind;
                    receiver.brdf.specular = glm::vec3(1.0F);
                    set_width(receiver, texel_angle(slab, receiver.position_m.z) /
                                            stated.texels_per_width * 1.0001F);
                    if (receiver.brdf.alpha.y > 1.0F || receiver.brdf.exponent < 1.0F)
                        continue;  // wider than any surface's
                    EXPECT_TRUE(texels_resolve_lobe(slab, receiver));
                    const glm::dvec3 expected = reflected_by_quadrature(slab, receiver, 5);
                    ASSERT_GT(expected.x, 0.0) << kind << " " << height_per_delta;
                    const glm::vec3 got = reflect_light(prepared, receiver).radiance;
                    errors.push_back(relative_error(glm::dvec3(got), expected));
                    EXPECT_LE(errors.back(), stated.worst)
                        << "kind " << kind << ", height " << height_per_delta;
                }
            }
        std::ranges::sort(errors);
        ASSERT_GT(errors.size(), 40U);
        EXPECT_LE(errors[errors.size() / 2], stated.median);
        const std::string name = "texels_per_width_" + std::to_string(stated.texels_per_width);
        RecordProperty(name + "_median_1e-6", std::to_string(errors[errors.size() / 2] * 1e6));
        RecordProperty(name + "_worst_1e-6", std::to_string(errors.back() * 1e6));
    }
}

// Proves colors: of the lamp, of the diffuse part, of a lobe whose color changes with the angle;
// for lamps of one channel as well; and that shares of images sum to the whole.
TEST(GlossySum, KeepsColorsAndSharesOfImages) {
    for (const int channels : {1, 3})
        for (const std::uint32_t kind : {shared::kBrdfGgx, shared::kBrdfWard}) {
            LampShape shape;
            shape.decades = 1;
            shape.channels = channels;
            const Slab slab =
                random_lamp(make_profile("bilinear"), Weighting::Irradiance, 31, shape);
            Random random{kind + 5};
            GlossyReceiver receiver = receiver_in_highlight(slab, random, 2.0);
            receiver.brdf.kind = kind;
            receiver.brdf.diffuse = {0.1F, 0.2F, 0.4F};
            receiver.brdf.specular = {0.9F, 0.5F, 0.1F};
            set_width(receiver, 4.0F * texel_angle(slab, receiver.position_m.z));
            std::vector<float> image_y(static_cast<std::size_t>(slab.image_count()), -1.0F);
            const Reflected got = reflect_light(prepare(slab), receiver, image_y);
            const glm::dvec3 expected = reflected_by_quadrature(slab, receiver, 8);
            for (int c = 0; c < 3; ++c)
                EXPECT_LE(std::abs(static_cast<double>(got.radiance[c]) / expected[c] - 1.0), 1e-3)
                    << channels << " channels, kind " << kind << ", " << c;
            double sum = 0.0;
            for (const float y : image_y) {
                EXPECT_GE(y, 0.0F);
                sum += static_cast<double>(y);
            }
            // Diffuse shares weigh an image's Y by the albedo's: the lamp's colors differ little.
            EXPECT_NEAR(sum / luminance(glm::dvec3(got.radiance)), 1.0, channels == 1 ? 1e-5 : 0.1);
        }
}

// Proves the parts that need no lobe: exactly albedo / pi times the irradiance; nothing behind U.
TEST(GlossySum, IsTheIrradianceWithoutLobeAndZeroBehindU) {
    const Slab slab = random_lamp(make_profile("bspline"), Weighting::Irradiance, 41);
    const PreparedSlab prepared = prepare(slab);
    Random random{6};
    GlossyReceiver receiver = receiver_in_highlight(slab, random, 2.0);
    receiver.brdf.diffuse = glm::vec3(0.5F);
    EXPECT_TRUE(texels_resolve_lobe(slab, receiver));
    const Reflected diffuse = reflect_light(prepared, receiver);
    EXPECT_GT(diffuse.irradiance.x, 0.0F);
    EXPECT_EQ(diffuse.irradiance,
              irradiance(prepared, ReceiverF{receiver.position_m, receiver.frame.z}));
    EXPECT_EQ(diffuse.radiance, diffuse.irradiance * (0.5F * shared::kInversePi));

    receiver.brdf.kind = shared::kBrdfGgx;
    receiver.brdf.specular = glm::vec3(0.5F);
    receiver.brdf.alpha = glm::vec2(0.4F);
    receiver.position_m.z = -1.01F * static_cast<float>(slab.delta_m);
    EXPECT_EQ(reflect_light(prepared, receiver).radiance, glm::vec3(0.0F));
}

// Proves that a surface whose plane passes through the lamp is as right, though no cubic follows
// the kink at its horizon.
TEST(GlossySum, IsRightAcrossTheHorizon) {
    constexpr double kAcrossHorizon = 5e-3;  // texels cut by the horizon are one node each
    LampShape shape;
    shape.decades = 1;
    shape.texels = {60, 50};
    const Slab slab = random_lamp(make_profile("bspline"), Weighting::Irradiance, 41, shape);
    const PreparedSlab prepared = prepare(slab);
    Random random{6};
    for (const double height_per_delta : {0.7, 1.5, 3.0, 3.5}) {
        GlossyReceiver receiver = receiver_in_highlight(slab, random, height_per_delta);
        receiver.brdf.kind = shared::kBrdfGgx;
        receiver.brdf.specular = glm::vec3(0.5F);
        receiver.brdf.alpha = glm::vec2(0.3F);
        const glm::vec3 to_u = glm::normalize(
            glm::vec3(glm::dvec3(slab.u_center_m, -slab.delta_m)) - receiver.position_m);
        const glm::vec3 any(static_cast<float>(random.uniform(-1.0, 1.0)), 1.0F, 0.2F);
        receiver.frame = shared::frame_from_normal(glm::normalize(glm::cross(to_u, any)));
        receiver.to_viewer_local = glm::normalize(glm::vec3(0.4F, -0.3F, 0.6F));
        ASSERT_TRUE(texels_resolve_lobe(slab, receiver));
        const glm::dvec3 expected = reflected_by_quadrature(slab, receiver, 12);
        ASSERT_GT(expected.x, 0.0);
        EXPECT_LE(relative_error(glm::dvec3(reflect_light(prepared, receiver).radiance), expected),
                  kAcrossHorizon)
            << height_per_delta;
    }
}

// Proves that what decides follows the texel's angle and the lobe's, and refuses S itself.
TEST(GlossySum, DecidesByTheAngleOfATexel) {
    const Slab slab = random_lamp(make_profile("bspline"), Weighting::Irradiance, 51);
    GlossyReceiver receiver;
    receiver.frame = shared::frame_from_normal({0, 0, -1});
    receiver.brdf.kind = shared::kBrdfPhong;
    receiver.brdf.specular = glm::vec3(0.5F);
    receiver.brdf.exponent = 100.0F;  // 0.1 rad; a texel is 12.5 mm wide
    const auto resolves_at = [&](float height_m) {
        receiver.position_m = {0.0F, 0.0F, height_m};
        return texels_resolve_lobe(slab, receiver);
    };
    EXPECT_TRUE(resolves_at(0.13F));
    EXPECT_FALSE(resolves_at(0.12F));
    EXPECT_TRUE(resolves_at(-0.13F));
    EXPECT_FALSE(resolves_at(0.0F));
    receiver.brdf.specular = glm::vec3(0.0F);
    EXPECT_TRUE(resolves_at(0.0F));
}

}  // namespace
}  // namespace nearfield::model

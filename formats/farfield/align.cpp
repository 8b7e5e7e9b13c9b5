// SPDX-License-Identifier: Apache-2.0
#include "formats/farfield/align.h"

#include "formats/farfield/least_squares.h"
#include "formats/model/luminaire.h"

#include <glm/gtc/constants.hpp>
#include <tbb/parallel_for.h>

#include <cmath>

namespace nearfield::farfield {
namespace {

// By a vector's length about its direction (Rodrigues).
glm::dmat3 rotation_by(const glm::dvec3& turn_rad) {
    const double angle = glm::length(turn_rad);
    if (angle == 0)
        return glm::dmat3(1.0);
    const glm::dvec3 k = turn_rad / angle;
    const glm::dmat3 cross(0, k.z, -k.y, -k.z, 0, k.x, k.y, -k.x, 0);
    return glm::dmat3(1.0) + std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
}

glm::dmat3 align_rotation(const LampView& a, const LampView& b, std::uint32_t seed) {
    constexpr int kDirections = 400, kTurns = 24;
    const std::vector<WeightedDirection> at = lit_directions(a, kDirections, seed);
    std::vector<double> expected(at.size());
    double largest = 0;
    for (std::size_t k = 0; k < at.size(); ++k)
        largest = std::max(largest, expected[k] = a.intensity(at[k].direction));
    const auto residuals_of = [&](const glm::dmat3& rotation) {
        std::vector<double> residuals(at.size());
        tbb::parallel_for(std::size_t{0}, at.size(), [&](std::size_t k) {
            residuals[k] =
                (b.intensity(glm::transpose(rotation) * at[k].direction) - expected[k]) / largest;
        });
        return residuals;
    };
    glm::dmat3 best(1.0);
    double least = -1;
    for (int turn = 0; turn < kTurns; ++turn) {
        const glm::dmat3 rotation = rotation_by({0, 0, glm::two_pi<double>() * turn / kTurns});
        double sum = 0;
        for (const double residual : residuals_of(rotation))
            sum += residual * residual;
        // Of equally good turns the first: a lamp that is the same all around stays.
        constexpr double kBetter = 0.999;
        if (least < 0 || sum < kBetter * least) {
            least = sum;
            best = rotation;
        }
    }
    constexpr double kStep_rad = 2e-3;
    const glm::dvec3 turn =
        least_squares([&](const glm::dvec3& x) { return residuals_of(best * rotation_by(x)); },
                      glm::dvec3(0.0), kStep_rad);
    return best * rotation_by(turn);
}

glm::dvec3 align_translation(const LampView& a,
                             const LampView& b,
                             const glm::dmat3& rotation,
                             std::uint32_t seed) {
    constexpr int kDirections = 150;
    const glm::dvec3 center_m = light_center_m(*a.lightfield);
    const double size_m = lamp_size_m(*a.lightfield);
    std::vector<model::Receiver> receivers;
    for (const WeightedDirection& at : lit_directions(a, kDirections, seed + 1))
        for (const double sizes : {2.0, 5.0})
            receivers.push_back({center_m + sizes * size_m * at.direction, -at.direction});
    std::vector<double> expected(receivers.size());
    tbb::parallel_for(std::size_t{0}, receivers.size(), [&](std::size_t k) {
        expected[k] = model::luminance(model::irradiance(*a.lightfield, receivers[k]));
    });
    const auto residuals = [&](const glm::dvec3& translation_m) {
        std::vector<double> result(receivers.size());
        tbb::parallel_for(std::size_t{0}, receivers.size(), [&](std::size_t k) {
            if (!(expected[k] > 0))
                return;
            const glm::dmat3 b_from_a = glm::transpose(rotation);
            const model::Receiver there{b_from_a * (receivers[k].position_m - translation_m),
                                        b_from_a * receivers[k].normal};
            result[k] = model::luminance(model::irradiance(*b.lightfield, there)) / expected[k] - 1;
        });
        return result;
    };
    constexpr double kStepInSizes = 0.01;
    return least_squares(residuals, center_m - rotation * light_center_m(*b.lightfield),
                         kStepInSizes * size_m);
}

}  // namespace

Rigid align(const LampView& a, const LampView& b, std::uint32_t seed) {
    Rigid a_from_b;
    a_from_b.rotation = align_rotation(a, b, seed);
    if (a.lightfield != nullptr && b.lightfield != nullptr)
        a_from_b.translation_m = align_translation(a, b, a_from_b.rotation, seed);
    return a_from_b;
}

}  // namespace nearfield::farfield

// SPDX-License-Identifier: Apache-2.0
#include "formats/rig/lens.h"

#include "formats/rig/lens_model.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace nearfield::rig {
namespace {

// A number with its derivatives by x and y: the slope of the one formula in lens_model.h.
struct Dual {
    double value = 0, by_x = 0, by_y = 0;

    Dual() = default;
    explicit Dual(double number) : value(number) {}
    Dual(double number, double slope_x, double slope_y)
        : value(number), by_x(slope_x), by_y(slope_y) {}
};

Dual chain(double value, double slope, const Dual& a) {
    return {value, slope * a.by_x, slope * a.by_y};
}
Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.by_x + b.by_x, a.by_y + b.by_y};
}
Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.by_x - b.by_x, a.by_y - b.by_y};
}
Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.by_x * b.value + a.value * b.by_x,
            a.by_y * b.value + a.value * b.by_y};
}
Dual operator/(const Dual& a, const Dual& b) {
    const double ratio = a.value / b.value;
    return {ratio, (a.by_x - ratio * b.by_x) / b.value, (a.by_y - ratio * b.by_y) / b.value};
}
bool operator<(const Dual& a, const Dual& b) {
    return a.value < b.value;
}
Dual sqrt(const Dual& a) {
    const double root = std::sqrt(a.value);
    return chain(root, 0.5 / root, a);
}
Dual atan(const Dual& a) {
    return chain(std::atan(a.value), 1.0 / (1.0 + a.value * a.value), a);
}

constexpr std::size_t kMostNumbers = 8;
using Numbers = std::array<Dual, kMostNumbers>;

// Distortion's numbers as constants.
Numbers constants_of(const Lens& lens) {
    Numbers k;
    for (std::size_t i = 0; i < lens.distortion.size() && i < k.size(); ++i)
        k[i] = Dual(lens.distortion[i]);
    return k;
}

struct Linear {
    glm::dvec2 value;
    glm::dmat2 slope;  // column: derivative by x, by y

    double determinant() const { return glm::determinant(slope); }
};

Linear linear_at(LensModel model, const Numbers& k, glm::dvec2 p) {
    const Point<Dual> d = distorted(model, k.data(), Dual(p.x, 1, 0), Dual(p.y, 0, 1));
    return {{d.x.value, d.y.value}, {d.x.by_x, d.y.by_x, d.x.by_y, d.y.by_y}};
}

// True where the picture is not yet folded back, on all of the way from the axis to a point.
bool is_unfolded(LensModel model, const Numbers& k, glm::dvec2 p) {
    constexpr int kSteps = 24;
    for (int step = 1; step <= kSteps; ++step) {
        if (!(linear_at(model, k, p * (double(step) / kSteps)).determinant() > 0.0))
            return false;
    }
    return true;
}

// Newton's iteration for distorted(p) = seen from a start, steps halved until the error falls.
std::optional<glm::dvec2> undistorted_from(LensModel model,
                                           const Numbers& k,
                                           glm::dvec2 seen,
                                           glm::dvec2 p) {
    constexpr int kMostSteps = 40, kMostHalvings = 12;
    constexpr double kDone = 1e-15;  // of tangents: below rounding of pixels at any focal length
    Linear at = linear_at(model, k, p);
    for (int step = 0; step < kMostSteps; ++step) {
        const double error = glm::length(at.value - seen);
        if (error < kDone)
            return p;
        if (!(at.determinant() > 0.0))
            return std::nullopt;
        glm::dvec2 change = glm::inverse(at.slope) * (seen - at.value);
        bool is_better = false;
        for (int halving = 0; halving < kMostHalvings && !is_better; ++halving) {
            const Linear next = linear_at(model, k, p + change);
            is_better = glm::length(next.value - seen) < error && next.determinant() > 0.0;
            if (is_better) {
                p += change;
                at = next;
            } else {
                change *= 0.5;
            }
        }
        // Where rounding stops the descent, we are there.
        if (!is_better)
            return error < 1e-13 * (1.0 + glm::length(seen)) ? std::optional(p) : std::nullopt;
    }
    return std::nullopt;
}

std::optional<glm::dvec2> undistorted_brown(const Lens& lens, glm::dvec2 seen) {
    const Numbers k = constants_of(lens);
    const auto quick = undistorted_from(lens.model, k, seen, seen);
    if (quick && is_unfolded(lens.model, k, *quick))
        return quick;
    // The start was beyond the fold, or the iteration ran there: go outwards in small steps.
    constexpr int kParts = 32;
    glm::dvec2 p(0.0);
    for (int part = 1; part <= kParts; ++part) {
        const auto next = undistorted_from(lens.model, k, seen * (double(part) / kParts), p);
        if (!next)
            return std::nullopt;
        p = *next;
    }
    return is_unfolded(lens.model, k, p) ? std::optional(p) : std::nullopt;
}

// The fisheye's formula is radial: bisection of the angle up to 90 degrees, then Newton's steps.
std::optional<glm::dvec2> undistorted_fisheye(const Lens& lens, glm::dvec2 seen) {
    const double wanted = glm::length(seen);
    if (wanted == 0.0)
        return glm::dvec2(0.0);
    const Numbers k = constants_of(lens);
    constexpr double kRightAngle = 1.57079632679489662;
    constexpr int kParts = 64;
    double low = 0.0, high = 0.0;
    for (int part = 1; part <= kParts && high == 0.0; ++part) {
        const double angle = kRightAngle * part / kParts;
        const Dual length = fisheye_length(k.data(), Dual(angle, 1, 0));
        if (length.value >= wanted)
            high = angle;
        else if (!(length.by_x > 0.0))
            return std::nullopt;
        else
            low = angle;
    }
    if (high == 0.0)
        return std::nullopt;
    double angle = 0.5 * (low + high);
    constexpr int kMostSteps = 60;
    for (int step = 0; step < kMostSteps; ++step) {
        const Dual length = fisheye_length(k.data(), Dual(angle, 1, 0));
        (length.value < wanted ? low : high) = angle;
        const double newton = angle + (wanted - length.value) / length.by_x;
        const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
        if (next == angle)
            break;
        angle = next;
    }
    if (!(angle < kRightAngle))
        return std::nullopt;
    return seen * (std::tan(angle) / wanted);
}

}  // namespace

int distortion_count(LensModel model) {
    switch (model) {
        case LensModel::Brown5:
            return 5;
        case LensModel::Brown8:
            return 8;
        case LensModel::Fisheye:
            return 4;
    }
    return 0;
}

std::optional<glm::dvec2> project_px(const Lens& lens, glm::dvec3 point_camera) {
    if (!(point_camera.z > 0.0))
        return std::nullopt;
    const Point<double> p =
        distorted(lens.model, lens.distortion.data(), point_camera.x / point_camera.z,
                  point_camera.y / point_camera.z);
    return glm::dvec2(lens.fx_px * p.x + lens.cx_px, lens.fy_px * p.y + lens.cy_px);
}

std::optional<glm::dvec3> ray_camera(const Lens& lens, glm::dvec2 position_px) {
    const glm::dvec2 seen((position_px.x - lens.cx_px) / lens.fx_px,
                          (position_px.y - lens.cy_px) / lens.fy_px);
    const auto tangents = lens.model == LensModel::Fisheye ? undistorted_fisheye(lens, seen)
                                                           : undistorted_brown(lens, seen);
    if (!tangents)
        return std::nullopt;
    return glm::dvec3(*tangents, 1.0);
}

}  // namespace nearfield::rig

// SPDX-License-Identifier: Apache-2.0
// Hard cases of the light sums: in float as renderers call them, in double as probe does, against
// the oracle at the very point that float represents.
#include "formats/model/luminaire.h"
#include "formats/model/prepared.h"
#include "formats/model/profile.h"
#include "formats/model/window_sum.h"
#include "tests/model/hard_cases.h"
#include "tests/model/hard_cases_errors.h"
#include "tests/support/lamps.h"
#include "tests/support/oracle.h"
#include "tests/support/receivers.h"

#include <algorithm>
#include <cmath>

namespace nearfield::test {
namespace {

using model::PreparedSlab;
using model::Receiver;
using model::ReceiverF;
using support::as_double;
using support::as_float;
using support::hard_receivers;
using support::HardReceiver;
using support::LampShape;
using support::oracle_irradiance;
using support::random_lamp;
using support::ReceiverKind;

// The integral over S in float, of a box basis for a receiver that faces it: delta^2 / Delta^2
// times each texel's part of a window.
float integral_over_s(const Slab& slab, const ReceiverF& receiver) {
    const auto delta_m = static_cast<float>(slab.delta_m);
    const glm::vec3 p_m = receiver.position_m;
    const glm::vec2 texel_m(slab.texel_m()), s_min_m(slab.s_min_m), pitch_m(slab.pitch_m);
    const auto window_part = [&](int axis, float u_m, int i) {
        const auto s_of = [&](float u) {
            return u + (p_m[axis] - u) * (delta_m / (delta_m + p_m.z));
        };
        const float texel_lo = s_min_m[axis] + static_cast<float>(i) * texel_m[axis];
        const float lo = std::max(s_of(u_m - 0.5F * pitch_m[axis]), texel_lo);
        const float hi = std::min(s_of(u_m + 0.5F * pitch_m[axis]), texel_lo + texel_m[axis]);
        return std::max(hi - lo, 0.0F);
    };
    float sum = 0.0F;
    for (int m = 0; m < slab.image_count(); ++m) {
        const glm::vec2 u_m(slab.basis_center_m(m % slab.grid.x, m / slab.grid.x));
        for (int j = 0; j < slab.texels.y; ++j)
            for (int i = 0; i < slab.texels.x; ++i)
                sum += slab.coeffs[slab.image_offset(0, m) +
                                   static_cast<std::size_t>(j * slab.texels.x + i)] *
                       window_part(0, u_m.x, i) * window_part(1, u_m.y, j);
    }
    return sum * (delta_m / p_m.z) * (delta_m / p_m.z);
}

HardRow just_above_s() {
    HardRow row{"relative error of E at Δ/δ = 1e-7, box basis, facing", 1e-3, 0.0, 0.0, 0.0};
    const Slab slab = random_lamp(model::make_profile("box"), Weighting::Irradiance, 71);
    const PreparedSlab prepared = model::prepare(slab);
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        const ReceiverF receiver = as_float(hard_receivers(slab, 1e-7, seed)[0].receiver);
        SumErrors errors;
        errors.add(slab, prepared, receiver);
        row.in_float = std::max(*row.in_float, errors.in_float);
        row.in_double = std::max(*row.in_double, errors.in_double);
        const double exact = oracle_irradiance(slab, as_double(receiver)).x;
        row.naive = std::max(*row.naive, relative_error(integral_over_s(slab, receiver), exact));
    }
    return row;
}

std::vector<HardRow> near_s() {
    std::vector<HardRow> rows;
    for (const Weighting weighting : kWeightings)
        for (const auto& [name, heights] :
             {std::pair<const char*, std::vector<double>>{
                  "0, ±1e-7, ±1e-4, ±1e-2", {0, 1e-7, -1e-7, 1e-4, -1e-4, 1e-2, -1e-2}},
              {"-0.9", {-0.9}}}) {
            const SumErrors errors = errors_at(weighting, heights, every_kind());
            rows.push_back({std::string("relative error of E at Δ/δ = ") + name + with(weighting),
                            1e-3, errors.in_float, errors.in_double});
        }
    rows.push_back(just_above_s());
    return rows;
}

std::vector<HardRow> behind_u() {
    double behind_float = 0, behind_double = 0, bad_float = 0, bad_double = 0;
    const auto is_bad = [](double e) { return e >= 0.0 && std::isfinite(e) ? 0.0 : 1.0; };
    for (const Weighting weighting : kWeightings) {
        const Slab slab = random_lamp(model::make_profile("bspline"), weighting, 52);
        const PreparedSlab prepared = model::prepare(slab);
        const auto delta_m = static_cast<float>(slab.delta_m);
        for (const glm::vec3 normal :
             {glm::vec3(0, 0, -1), glm::vec3(0, 0, 1), glm::vec3(1, 0, 0)}) {
            for (const float behind : {1e-6F, 0.1F, 1.0F, 1e6F}) {
                const ReceiverF receiver{{0.01F, 0.0F, -delta_m * (1.0F + behind)}, normal};
                behind_float = std::max<double>(behind_float, irradiance(prepared, receiver).x);
                behind_double = std::max(behind_double, irradiance(slab, as_double(receiver)).x);
            }
            for (const float z_m : {-delta_m, std::nextafter(-delta_m, 0.0F)}) {
                const ReceiverF receiver{{0.01F, 0.0F, z_m}, normal};
                bad_float += is_bad(irradiance(prepared, receiver).x);
                bad_double += is_bad(irradiance(slab, as_double(receiver)).x);
            }
        }
    }
    return {{"largest E behind U", 0.0, behind_float, behind_double},
            {"results at U that are negative or not finite", 0.0, bad_float, bad_double}};
}

// u of the ray from p through s, in pitches, by the two formulas that are algebraically one.
HardRow far_rays(const Slab& slab, double height_per_delta) {
    HardRow row{"error of a ray's u in pitches", 1e-3, 0.0, std::nullopt, 0.0};
    const auto delta_m = static_cast<float>(slab.delta_m);
    const auto pitch_m = static_cast<double>(slab.pitch_m.x);
    const auto z_m = static_cast<float>(height_per_delta * slab.delta_m);
    for (const float s_m : {-0.12F, -0.031F, 0.007F, 0.16F})
        for (const float u_m : {-0.05F, 0.013F, 0.049F}) {
            const float p_m = s_m + (s_m - u_m) * static_cast<float>(height_per_delta);
            const double exact_m =
                s_m + (static_cast<double>(s_m) - p_m) * static_cast<double>(delta_m) / z_m;
            const shared::AxisView view = shared::axis_view(p_m, delta_m, z_m);
            const float product_m = u_of_e(view, e_of_s(view, s_m));
            const float naive_m = p_m + (s_m - p_m) * ((delta_m + z_m) / z_m);
            row.in_float = std::max(*row.in_float, std::abs(product_m - exact_m) / pitch_m);
            row.naive = std::max(*row.naive, std::abs(naive_m - exact_m) / pitch_m);
        }
    return row;
}

std::vector<HardRow> far_away() {
    constexpr double kFarPerDelta = 1e6;
    SumErrors to_intensity;
    for (const Weighting weighting : kWeightings) {
        LampShape shape;
        shape.decades = 1;
        const Slab slab = random_lamp(model::make_profile("bspline"), weighting, 41, shape);
        const PreparedSlab prepared = model::prepare(slab);
        for (const glm::dvec3 direction :
             {glm::dvec3(0, 0, 1), glm::dvec3(0.3, -0.2, 1), glm::dvec3(-0.41, 0.13, 2)}) {
            const double r_m = kFarPerDelta * slab.delta_m;
            const glm::dvec3 unit = glm::normalize(direction);
            const ReceiverF receiver = as_float({r_m * unit, -unit});
            const glm::dvec3 p_m(receiver.position_m);
            const double truth = support::oracle_intensity(slab, p_m).x;
            const double r2_m2 = glm::dot(p_m, p_m);
            to_intensity.in_float =
                std::max(to_intensity.in_float,
                         relative_error(irradiance(prepared, receiver).x * r2_m2, truth));
            to_intensity.in_double =
                std::max(to_intensity.in_double,
                         relative_error(irradiance(slab, as_double(receiver)).x * r2_m2, truth));
        }
    }
    std::vector<HardRow> rows = {{"relative error of E r² against intensity, 1e6 δ away", 1e-3,
                                  to_intensity.in_float, to_intensity.in_double}};
    for (const Weighting weighting : kWeightings) {
        const SumErrors errors = errors_at(weighting, {1e3, 1e6}, every_kind());
        rows.push_back({"relative error of E, 1e3 and 1e6 δ away" + with(weighting), 1e-3,
                        errors.in_float, errors.in_double});
    }
    rows.push_back(far_rays(random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 1),
                            kFarPerDelta));
    return rows;
}

std::vector<HardRow> angles() {
    struct Group {
        const char* name;
        std::vector<ReceiverKind> kinds;
    };
    std::vector<HardRow> rows;
    double negative = 0;
    for (const Weighting weighting : kWeightings)
        for (const Group& group :
             {Group{"facing and tilted receivers", {ReceiverKind::Facing, ReceiverKind::Tilted}},
              Group{"planes that cut the aperture", {ReceiverKind::Cut}},
              Group{"receivers that see S's border, its outside or nothing",
                    {ReceiverKind::Partial, ReceiverKind::Beside, ReceiverKind::Back}}}) {
            const SumErrors errors = errors_at(weighting, every_height(), group.kinds);
            negative += errors.negative;
            rows.push_back({std::string("relative error of E, ") + group.name + with(weighting),
                            1e-3, errors.in_float, errors.in_double});
        }
    rows.push_back({"results that are negative or not finite", 0.0, negative, negative});
    return rows;
}

// Clamped per window instead of per texel, as a sum of moments invites.
double sum_clamped_by_window(const Slab& slab, const Receiver& receiver) {
    const glm::dvec3 p_m = receiver.position_m, n = receiver.normal;
    const model::AxisWindows x = model::make_windows(slab, 0, p_m.x, p_m.z);
    const model::AxisWindows y = model::make_windows(slab, 1, p_m.y, p_m.z);
    double total = 0.0;
    for (int m = 0; m < slab.image_count(); ++m) {
        const model::AxisWindow& wx = x.of_basis[static_cast<std::size_t>(m % slab.grid.x)];
        const model::AxisWindow& wy = y.of_basis[static_cast<std::size_t>(m / slab.grid.x)];
        double sum = 0.0;
        for (std::size_t j = 0; j < wy.m0.size(); ++j)
            for (std::size_t i = 0; i < wx.m0.size(); ++i) {
                const std::size_t at = (static_cast<std::size_t>(wy.range.first) + j) *
                                           static_cast<std::size_t>(slab.texels.x) +
                                       static_cast<std::size_t>(wx.range.first) + i;
                const double c = slab.coeffs[slab.image_offset(0, m) + at];
                sum += c * (n.x * wx.m1[i] * wy.m0[j] + n.y * wx.m0[i] * wy.m1[j] -
                            n.z * wx.m0[i] * wy.m0[j]);
            }
        total += std::max(sum, 0.0);
    }
    return slab.delta_m * slab.delta_m * total;
}

std::vector<HardRow> grazing() {
    HardRow row{"relative error of E at 85° to 89.9° of incidence", 1e-3, 0.0, 0.0, 0.0};
    LampShape shape;
    shape.decades = 1;
    const Slab slab = random_lamp(model::make_profile("bspline"), Weighting::Irradiance, 17, shape);
    const PreparedSlab prepared = model::prepare(slab);
    for (const double degrees : {85.0, 88.0, 89.0, 89.9})
        for (const double azimuth : {0.3, 1.9, 4.0}) {
            const double angle = degrees * std::acos(-1.0) / 180.0;
            const ReceiverF receiver =
                as_float({{0.01, -0.02, 2.0 * slab.delta_m},
                          {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
                           -std::cos(angle)}});
            SumErrors errors;
            errors.add(slab, prepared, receiver);
            row.in_float = std::max(*row.in_float, errors.in_float);
            row.in_double = std::max(*row.in_double, errors.in_double);
            row.naive = std::max(*row.naive,
                                 relative_error(sum_clamped_by_window(slab, as_double(receiver)),
                                                oracle_irradiance(slab, as_double(receiver)).x));
        }
    return {row};
}

// 1 / R^4 over texels as wide as one node is trusted with, and wider.
std::vector<HardRow> wide_texels() {
    LampShape shape;
    shape.decades = 1;
    const Slab slab = random_lamp(model::make_profile("bspline"), Weighting::Radiance, 23, shape);
    const double texel_m = std::max(slab.texel_m().x, slab.texel_m().y);
    const PreparedSlab prepared = model::prepare(slab);
    PreparedSlab by_centroids = prepared;
    by_centroids.widest_centroid_texel_t = INFINITY;
    std::vector<HardRow> rows;
    for (const double width_t : {0.99 * model::kWidestCentroidTexelT, 0.1, 0.5}) {
        HardRow row{"relative error of E, texels of " + std::to_string(width_t).substr(0, 5) +
                        " in tangents, radiance weighting",
                    1e-4, 0.0, 0.0};
        for (std::uint64_t seed = 0; seed < 5; ++seed) {
            const ReceiverF receiver =
                as_float(hard_receivers(slab, texel_m / width_t / slab.delta_m, seed)[0].receiver);
            SumErrors errors;
            errors.add(slab, prepared, receiver);
            row.in_float = std::max(*row.in_float, errors.in_float);
            row.in_double = std::max(*row.in_double, errors.in_double);
            if (width_t > model::kWidestCentroidTexelT)
                row.naive =
                    std::max(row.naive.value_or(0.0),
                             relative_error(irradiance(by_centroids, receiver).x,
                                            oracle_irradiance(slab, as_double(receiver)).x));
        }
        rows.push_back(row);
    }
    return rows;
}

}  // namespace

std::vector<HardCase> sum_cases() {
    return {
        {"NearS", "Δ → 0, p on S, between the planes",
         "S form: 0/0, and a box smaller than a texel in float", near_s},
        {"BehindU", "p at U or behind it", "division by zero", behind_u},
        {"FarAway", "p very far",
         "u = p + (s − p)(δ + Δ)/Δ takes a difference of large numbers; box − box cancels",
         far_away},
        {"Angles", "tilted, cutting, back-facing receivers, p beside the box, Δ/δ from −0.9 to 1e6",
         "sign errors", angles},
        {"Grazing", "grazing receivers", "the cosine clamped per window, not per texel", grazing},
        {"WideTexels", "texels seen at a wide angle", "one node a texel for 1/R⁴", wide_texels},
    };
}

}  // namespace nearfield::test

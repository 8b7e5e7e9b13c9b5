// SPDX-License-Identifier: Apache-2.0
#include "formats/rays/to_lightfield.h"

#include "formats/files/error.h"
#include "formats/model/profile.h"
#include "formats/model/slab_axes.h"
#include "formats/rays/coefficients.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace nearfield::rays {
namespace {

constexpr std::array kAxisNames = {"+z", "+x", "-x", "+y", "-y", "-z"};
// U this many sides of S's rectangle behind S: farther, a pitch means the same direction all over
// S, which is what keeps the grid small; nearer, U stays within the lamp.
constexpr double kDepthInSides = 2.0;
// U stays behind the first ray start by this part of the planes' distance.
constexpr double kBehindStarts = 0.05;
// Flux that a rectangle may leave out beyond each edge. One slab has no end of slanting rays: cut
// more.
constexpr double kTrimOneSlab = 2e-3;
constexpr double kTrimBox = 1e-4;
// A slab is worth having if without it more than this part of the flux were lost.
constexpr double kWorthASlab = 0.01;
// Cross-validation on more rays than this costs time and changes little.
constexpr std::size_t kMostRaysToChoose = 400000;
// Coefficients a slab and channel may have at most: 1 GiB as floats, and as much for their sigma.
constexpr double kMostCoefficients = 268435456.0;

const std::vector<glm::vec3> kNoColors;

// Refuses more coefficients than a slab may have, with the memory they would take.
void check_count(glm::ivec2 grid, glm::ivec2 texels, const std::string& where) {
    const glm::dvec2 across = glm::dvec2(grid) * glm::dvec2(texels);
    const double count = across.x * across.y;
    if (count > kMostCoefficients)
        throw Error{"too many coefficients", where, "grid times texels at most 268 million",
                    fmt::format("{}x{} images of {}x{} texels: {:.0f} million, {:.1f} GiB of "
                                "memory a slab and channel",
                                grid.x, grid.y, texels.x, texels.y, 1e-6 * count,
                                count * 2 * sizeof(float) / (1 << 30))};
}

// Which rays go to which slab.
struct Members {
    std::array<std::vector<Member>, 6> of_slab;
    double dropped_flux = 0, dropped_rays = 0;
    AngleRange dropped_angles;
};

// Slanting more than this, a ray reaches planes a metre apart a kilometre aside.
constexpr float kLeastCosine = 1e-3F;

Members share_out_directions(const RaySet& set, int slab_count) {
    Members members;
    for (std::size_t r = 0; r < set.rays.size(); ++r) {
        const glm::vec3 direction = set.rays[r].direction;
        const std::array<float, 6> shares = model::slab_shares(direction, slab_count);
        const bool too_slanting = slab_count == 1 && direction.z < kLeastCosine;
        bool taken = false;
        for (std::size_t s = 0; s < shares.size() && !too_slanting; ++s)
            if (shares[s] > 0.0F) {
                members.of_slab[s].push_back({static_cast<std::uint32_t>(r), shares[s]});
                taken = true;
            }
        if (!taken) {
            members.dropped_flux += set.rays[r].flux;
            members.dropped_rays += 1.0;
            members.dropped_angles.add(direction);
        }
    }
    return members;
}

int choose_slab_count(const RaySet& set) {
    std::array<double, 6> of_axis{};
    for (const Ray& ray : set.rays)
        of_axis[static_cast<std::size_t>(model::dominant_slab(ray.direction))] += ray.flux;
    double total = 0.0;
    for (const double f : of_axis)
        total += f;
    if (of_axis[5] > kWorthASlab * total)
        return 6;
    return total - of_axis[0] > kWorthASlab * total ? 5 : 1;
}

// Planes of one slab: as asked for, or S at the waist and U behind everything.
Planes choose_planes(const RaySet& set,
                     const std::vector<Member>& members,
                     int slab,
                     const ConvertOptions& options,
                     double trim) {
    Planes planes;
    planes.file_from_slab = model::axes_from_slab(slab);
    const Waist waist = find_waist(set, members, planes.file_from_slab);
    const bool is_first = slab == 0;
    planes.s_m = is_first && options.s_plane_mm ? *options.s_plane_mm * 1e-3 : waist.s_m;
    planes.u_m = planes.s_m;
    const Rectangle s = bound_s(propagate(set, members, planes), trim);
    const glm::dvec2 side = s.max_m - s.min_m;
    const double behind = std::max(0.0, planes.s_m - waist.first_start_m) * (1.0 + kBehindStarts);
    planes.u_m = is_first && options.u_plane_mm
                     ? *options.u_plane_mm * 1e-3
                     : planes.s_m - std::max(kDepthInSides * std::max(side.x, side.y), behind);
    if (!(planes.u_m < planes.s_m) || !std::isfinite(planes.s_m - planes.u_m))
        throw Error{"planes out of order",
                    fmt::format("slab {}", kAxisNames[static_cast<std::size_t>(slab)]),
                    "U behind S, at finite distances",
                    fmt::format("U at {} mm, S at {} mm", planes.u_m * 1e3, planes.s_m * 1e3)};
    return planes;
}

// Removes the crossings outside the rectangle; calls tell(crossing) for each.
template <typename Coordinate, typename Tell>
void drop_outside(std::vector<Crossing>& crossings,
                  const Rectangle& rectangle,
                  const Coordinate& coordinate,
                  const Tell& tell) {
    const auto outside = [&](const Crossing& c) {
        const glm::dvec2 x(coordinate(c));
        const bool inside = x.x >= rectangle.min_m.x && x.x < rectangle.max_m.x &&
                            x.y >= rectangle.min_m.y && x.y < rectangle.max_m.y;
        if (!inside)
            tell(c);
        return !inside;
    };
    crossings.erase(std::remove_if(crossings.begin(), crossings.end(), outside), crossings.end());
}

// Rays whose fold comes first, as many as cross-validation needs.
std::vector<Crossing> thin(const std::vector<Crossing>& crossings, std::uint64_t seed) {
    if (crossings.size() <= kMostRaysToChoose)
        return crossings;
    std::vector<Crossing> some;
    const std::size_t stride = crossings.size() / kMostRaysToChoose + 1;
    for (std::size_t r = seed % stride; r < crossings.size(); r += stride)
        some.push_back(crossings[r]);
    return some;
}

void describe(SlabReport& report, const Planes& planes, const Slab& slab, const TexelFlux& flux) {
    report.u_plane_mm = planes.u_m * 1e3;
    report.s_plane_mm = planes.s_m * 1e3;
    report.texel_mm = std::max(slab.texel_m().x, slab.texel_m().y) * 1e3;
    report.pitch_deg = std::atan(std::max(slab.pitch_m.x, slab.pitch_m.y) / slab.delta_m) * 180.0 /
                       std::numbers::pi;
    double sigma = 0.0;
    for (std::size_t t = 0; t < flux.flux.size(); ++t) {
        report.flux += flux.flux[t];
        sigma += std::sqrt(flux.variance[t]);
    }
    report.sigma_texel_rel = report.flux > 0.0 ? sigma / report.flux : 0.0;
}

// What crosses a slab's rectangles on both planes.
struct Crossings {
    std::vector<Crossing> crossings;
    Rectangle s, u;
};

// Follows the rays to the planes and bounds them there. Adds what is dropped to `total`.
Crossings cross(const RaySet& set,
                const std::vector<Member>& members,
                const Planes& planes,
                double trim,
                ConvertReport& total) {
    std::vector<Crossing> crossings = propagate(set, members, planes);
    const auto count_in = [&](double& flux, AngleRange& angles) {
        return [&](const Crossing& c) {
            flux += static_cast<double>(c.flux);
            total.rays_dropped += static_cast<double>(c.share);
            angles.add(set.rays[c.ray].direction);
        };
    };
    const Rectangle s = bound_s(crossings, trim);
    drop_outside(
        crossings, s, [](const Crossing& c) { return c.s_m; },
        count_in(total.dropped_s, total.s_angles));
    const Rectangle u = bound_u(crossings, trim);
    drop_outside(
        crossings, u, [](const Crossing& c) { return c.u_m; },
        count_in(total.dropped_u, total.u_angles));
    return {std::move(crossings), s, u};
}

struct Part {
    Slab slab;
    SlabReport report;
    Planes planes;
};

// One slab from its rays. Adds what is dropped to `total`.
Part convert_slab(const RaySet& set,
                  const std::vector<Member>& members,
                  int index,
                  const Planes* first,
                  const ConvertOptions& options,
                  double trim,
                  ConvertReport& total) {
    Part part;
    part.report.axis = kAxisNames[static_cast<std::size_t>(index)];
    part.planes = choose_planes(set, members, index, options, trim);
    const auto [crossings, s, u] = cross(set, members, part.planes, trim, total);
    if (crossings.empty())
        throw Error{"no ray crosses a slab's rectangles", "slab " + part.report.axis};
    part.report.rays = crossings.size();

    const Profile profile = model::make_profile(options.basis);
    const std::vector<Crossing> some = thin(crossings, options.seed);
    part.report.texels = choose_texels(some, s, options.texels, options.seed);
    if (options.grid)
        check_count(*options.grid, part.report.texels.texels, "slab " + part.report.axis);
    part.report.directions = choose_directions(some, s, u, profile, options.grid, options.seed);
    const TexelGrid grid{s, part.report.texels.texels};
    const Aperture aperture = cover(profile, u, part.report.directions.grid);
    check_count(aperture.grid, grid.texels, "slab " + part.report.axis);

    const TexelFlux flux = smooth_flux(crossings, grid, part.report.texels.kernel_texels);
    const std::vector<glm::vec3>& colors = options.color ? set.colors : kNoColors;
    const std::vector<BlockShares> fits =
        fit_directions(crossings, s, aperture, part.report.directions.levels, colors);
    part.slab = make_slab(part.planes, first != nullptr ? *first : part.planes, aperture, grid);
    fill(part.slab, grid, flux, fits, colors);
    describe(part.report, part.planes, part.slab, flux);
    return part;
}

}  // namespace

void check(const ConvertOptions& options) {
    if (options.slabs && *options.slabs != 1 && *options.slabs != 5 && *options.slabs != 6)
        throw Error{"bad number of slabs", "--slabs", "1, 5 or 6", std::to_string(*options.slabs)};
    const auto n = static_cast<int>(model::make_profile(options.basis).cells.size());
    if (options.grid && (options.grid->x < n || options.grid->y < n))
        throw Error{"grid too small for its basis", "--grid", fmt::format("at least {0}x{0}", n),
                    fmt::format("{}x{}", options.grid->x, options.grid->y)};
    if (options.texels && (options.texels->x < 1 || options.texels->y < 1))
        throw Error{"bad number of texels", "--texels", "at least 1x1",
                    fmt::format("{}x{}", options.texels->x, options.texels->y)};
    // The least that what is given asks for: an automatic grid has one pitch or more.
    check_count(options.grid.value_or(glm::ivec2(n)), options.texels.value_or(glm::ivec2(1)),
                "--grid, --texels");
    for (const auto& plane : {options.u_plane_mm, options.s_plane_mm})
        if (plane && !std::isfinite(*plane))
            throw Error{"bad plane", "--u-plane-mm, --s-plane-mm", "a finite number"};
}

Conversion to_lightfield(const RaySet& set, const ConvertOptions& options) {
    check(options);
    Conversion result;
    ConvertReport& report = result.report;
    report.rays_in = set.rays.size();
    report.flux_in = flux(set);
    if (!(report.flux_in > 0.0))
        throw Error{"rays without light", "", "flux > 0"};
    const int slab_count = options.slabs.value_or(choose_slab_count(set));
    const Members members = share_out_directions(set, slab_count);
    report.dropped_direction = members.dropped_flux;
    report.rays_dropped = members.dropped_rays;
    report.direction_angles = members.dropped_angles;
    if (members.of_slab[0].empty())
        throw Error{"no ray goes towards +z", "first slab",
                    "a lamp that shines along its file's +z"};

    const double trim = slab_count == 1 ? kTrimOneSlab : kTrimBox;
    std::optional<Planes> first;
    double done = 0.0;
    for (int s = 0; s < slab_count; ++s) {
        const std::vector<Member>& rays = members.of_slab[static_cast<std::size_t>(s)];
        double slab_flux = 0.0;
        for (const Member& member : rays)
            slab_flux += static_cast<double>(set.rays[member.ray].flux) * member.share;
        if (!(slab_flux > 0.0))
            continue;
        Part part = convert_slab(set, rays, s, first ? &*first : nullptr, options, trim, report);
        if (!first)
            first = part.planes;
        report.flux_out += part.report.flux;
        report.slabs.push_back(std::move(part.report));
        result.lightfield.slabs.push_back(std::move(part.slab));
        done += slab_flux;
        if (options.progress)
            options.progress(done / (report.flux_in - report.dropped_direction));
    }
    double squares = 0.0;
    for (const Ray& ray : set.rays)
        squares += static_cast<double>(ray.flux) * ray.flux;
    report.sigma_flux = std::sqrt(squares * report.flux_out / report.flux_in);
    result.lightfield.quantity = set.quantity;
    return result;
}

void AngleRange::add(glm::vec3 direction) {
    const double deg =
        std::acos(std::clamp(static_cast<double>(direction.z), -1.0, 1.0)) * 180 / std::numbers::pi;
    least_deg = std::min(least_deg, deg);
    most_deg = std::max(most_deg, deg);
}

}  // namespace nearfield::rays

// SPDX-License-Identifier: Apache-2.0
#include "sample_data/bench/lens_light.h"

#include "sample_data/bench/transmission.h"

#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace nearfield::sample_data {
namespace {

// Most points of a line between which tangent.y and transmission are interpolated linearly, and the
// way on the filter, in pitches, that they may span: linear interpolation of a profile whose second
// derivative is 2 (bspline's largest) is then wrong by 6e-4 at most.
constexpr std::size_t kMostBlock = 32;
constexpr double kBlockOnFilter = 0.05;

// Three-point Gauss nodes at half the narrowest step of radiance, on average: 1e-4 of a smooth
// step's integral. Transmission asks for a twelfth of the filter's width per node.
constexpr double kNodesPerFeature = 2.0;
constexpr double kNodesPerPitch = 6.0;
// A block is a row of the lamp's own axes where tangent.y differs by less than this of a feature.
constexpr double kSameTangent = 0.01;
// A profile that jumps (box) is averaged over a node's own share of the lens, which then is small.
constexpr double kNodesPerPitchOfJumps = 24.0;

bool has_jumps(const Profile& profile) {
    const double half = 0.5 * static_cast<double>(profile.cells.size());
    double before = 0.0;
    for (std::size_t c = 0; c <= profile.cells.size(); ++c) {
        const double x = static_cast<double>(c) - half;
        const auto value = [&](std::size_t cell) {
            const std::array<double, 3>& a = profile.cells[cell];
            return a[0] + x * (a[1] + x * a[2]);
        };
        if (c > 0)
            before = value(c - 1);
        const double after = c < profile.cells.size() ? value(c) : 0.0;
        if (std::abs((c > 0 ? before : 0.0) - after) > 1e-9)
            return true;
    }
    return false;
}

// Transmissions of all positions for one ray.
class Transmissions {
  public:
    Transmissions(const Bench& bench, const Places& places)
        : filter_(bench.filter),
          places_(places),
          filter_from_bench_(inverse(places.bench_from_filter)),
          inverse_pitch_(1.0 / bench.filter.pitch_m) {
        is_averaged_ = has_jumps(filter_.profile);
        half_support_ =
            0.5 * static_cast<double>(filter_.profile.cells.size()) + (is_averaged_ ? 1.0 : 0.0);
    }

    // value[m] for the ray from a lens node, of this size, to a point.
    void evaluate(glm::dvec3 node_bench,
                  glm::dvec2 node_size_m,
                  glm::dvec3 point_bench,
                  std::vector<double>& value) const {
        std::fill(value.begin(), value.end(), 0.0);
        const glm::dvec3 node = apply(filter_from_bench_, node_bench);
        const glm::dvec3 ray = apply(filter_from_bench_, point_bench) - node;
        const std::optional<double> t = meet_plane(node, ray);
        if (!t)
            return;
        const glm::dvec2 at_m = glm::dvec2(node) + *t * glm::dvec2(ray);
        const glm::dvec2 width =
            is_averaged_ ? glm::abs((1.0 - *t) * node_size_m * inverse_pitch_) : glm::dvec2(0.0);
        for (std::size_t m = 0; m < value.size(); ++m) {
            const glm::dvec2 x = (at_m - places_.position_m[m]) * inverse_pitch_;
            if (std::abs(x.x) < half_support_ && std::abs(x.y) < half_support_)
                value[m] = mean_transmission(filter_.profile, x.x, width.x) *
                           mean_transmission(filter_.profile, x.y, width.y);
        }
    }

  private:
    const BenchFilter& filter_;
    const Places& places_;
    Rigid filter_from_bench_;
    glm::dvec2 inverse_pitch_{1.0};
    double half_support_ = 0.0;
    bool is_averaged_ = false;
};

// Adds one lens node's light on a line of points, block by block.
class LineIntegrator {
  public:
    LineIntegrator(const LensLight& light,
                   std::span<const glm::dvec3> points_bench,
                   glm::dvec3 normal_bench,
                   const SeenColors& colors,
                   int position_count)
        : light_(light),
          points_bench_(points_bench),
          colors_(colors),
          transmissions_(*light.bench, *light.places),
          count_(points_bench.size()),
          positions_(static_cast<std::size_t>(position_count)) {
        const Rigid emitter_from_bench = inverse(light.bench_from_emitter);
        for (const glm::dvec3& point : points_bench)
            points_.push_back(apply(emitter_from_bench, point));
        normal_ = emitter_from_bench.rotation * normal_bench;
        first_.resize(positions_);
        last_.resize(positions_);
        result_.open.resize(colors.size() * count_);
        result_.positions.resize(positions_ * colors.size() * count_);
    }

    LineLight integrate() {
        const std::size_t block = block_size();
        for (const ApertureRow& row : light_.rows) {
            for (const Node& x : row.x) {
                is_last_known_ = false;
                for (std::size_t begin = 0; begin < count_; begin += block)
                    add_block({x.at_m, row.y.at_m}, {x.weight_m, row.y.weight_m}, begin,
                              std::min(begin + block, count_));
            }
        }
        return std::move(result_);
    }

  private:
    // How many points a block may have, by how far apart their rays meet the filter.
    std::size_t block_size() const {
        if (count_ < 2)
            return 1;
        const Rigid filter_from_bench = inverse(light_.places->bench_from_filter);
        const double step_m = glm::length(points_bench_[1] - points_bench_[0]);
        const glm::dvec2 half_m = light_.lamp.aperture.half_m;
        double most_share = 0.0;  // of the way from lens to screen that lies before the filter
        for (const glm::dvec2 corner : {half_m, glm::dvec2(half_m.x, -half_m.y)}) {
            for (const double sign : {-1.0, 1.0}) {
                const glm::dvec3 node =
                    apply(filter_from_bench,
                          apply(light_.bench_from_emitter, glm::dvec3(sign * corner, 0.0)));
                const double screen_z = apply(filter_from_bench, points_bench_[0]).z;
                most_share = std::max(most_share, std::abs(node.z / (screen_z - node.z)));
            }
        }
        const double pitch_m =
            std::min(light_.bench->filter.pitch_m.x, light_.bench->filter.pitch_m.y);
        const double points = kBlockOnFilter * pitch_m / std::max(step_m * most_share, 1e-12);
        return static_cast<std::size_t>(std::clamp(points, 1.0, double(kMostBlock)));
    }

    // Radiance times cosines over squared distance times area: rgb_[channel][i].
    bool weigh_radiance(glm::dvec2 a_m, double area_m2, std::size_t begin, std::size_t size) {
        std::array<double, kMostBlock> tangent_x{}, weight{};
        for (std::size_t i = 0; i < size; ++i) {
            const glm::dvec3 d = points_[begin + i] - glm::dvec3(a_m, 0.0);
            const double inverse_square = 1.0 / glm::dot(d, d);
            tangent_x[i] = d.x / d.z;
            weight[i] = d.z > 0.0 ? area_m2 * std::max(0.0, -glm::dot(d, normal_)) * d.z *
                                        inverse_square * inverse_square
                                  : 0.0;
        }
        const auto tangent_y = [&](std::size_t i) {
            return (points_[begin + i].y - a_m.y) / points_[begin + i].z;
        };
        const double first = tangent_y(0), last = tangent_y(size - 1);
        const std::span<const double> tangents(tangent_x.data(), size);
        light_.lamp.radiance_row(a_m, first, tangents, {rgb_.data(), 3 * size});
        if (std::abs(last - first) > kSameTangent * light_.lamp.feature_tangent.y) {
            light_.lamp.radiance_row(a_m, last, tangents, {rgb_last_.data(), 3 * size});
            for (std::size_t i = 0; i < size; ++i) {
                const double share = (tangent_y(i) - first) / (last - first);
                for (std::size_t k = i; k < 3 * size; k += size)
                    rgb_[k] += share * (rgb_last_[k] - rgb_[k]);
            }
        }
        double sum = 0.0;
        for (std::size_t i = 0; i < size; ++i) {
            for (std::size_t k = i; k < 3 * size; k += size) {
                rgb_[k] *= weight[i];
                sum += rgb_[k];
            }
        }
        return sum > 0.0;
    }

    // Transmissions at a block's first point and at the next block's; the latter are kept for it.
    void find_transmissions(glm::dvec2 a_m,
                            glm::dvec2 node_size_m,
                            std::size_t begin,
                            std::size_t end) {
        const glm::dvec3 node_bench = apply(light_.bench_from_emitter, glm::dvec3(a_m, 0.0));
        if (is_last_known_)
            std::swap(first_, last_);
        else
            transmissions_.evaluate(node_bench, node_size_m, points_bench_[begin], first_);
        const std::size_t next = std::min(end, count_ - 1);
        transmissions_.evaluate(node_bench, node_size_m, points_bench_[next], last_);
        lit_.clear();
        const double steps = static_cast<double>(std::max<std::size_t>(next - begin, 1));
        for (std::size_t m = 0; m < positions_; ++m) {
            if (first_[m] > 0.0 || last_[m] > 0.0)
                lit_.push_back({m, first_[m], (last_[m] - first_[m]) / steps});
        }
        is_last_known_ = true;
    }

    void add_block(glm::dvec2 a_m, glm::dvec2 node_size_m, std::size_t begin, std::size_t end) {
        const std::size_t size = end - begin;
        if (!weigh_radiance(a_m, node_size_m.x * node_size_m.y, begin, size)) {
            is_last_known_ = false;
            return;
        }
        if (positions_ > 0)
            find_transmissions(a_m, node_size_m, begin, end);
        const glm::dvec3 tint = light_.bench->filter.transmission;
        for (std::size_t p = 0; p < colors_.size(); ++p) {
            const glm::dvec3 open = colors_[p], filtered = colors_[p] * tint;
            std::array<double, kMostBlock> seen{};
            double* const to = &result_.open[p * count_ + begin];
            for (std::size_t i = 0; i < size; ++i) {
                const double r = rgb_[i], g = rgb_[size + i], b = rgb_[2 * size + i];
                to[i] += open.x * r + open.y * g + open.z * b;
                seen[i] = filtered.x * r + filtered.y * g + filtered.z * b;
            }
            for (const Lit& lit : lit_)
                add_position(
                    lit, seen,
                    {&result_.positions[(lit.m * colors_.size() + p) * count_ + begin], size});
        }
    }

    // A position that lets light of this node through to this block.
    struct Lit {
        std::size_t m = 0;
        double first = 0.0, step = 0.0;  // transmission at the block's first point, and per point
    };

    static void add_position(const Lit& lit,
                             const std::array<double, kMostBlock>& seen,
                             std::span<double> to) {
        const int size = static_cast<int>(to.size());
        double* const target = to.data();
        for (int i = 0; i < size; ++i)
            target[i] += seen[static_cast<std::size_t>(i)] * (lit.first + lit.step * i);
    }

    const LensLight& light_;
    std::span<const glm::dvec3> points_bench_;
    const SeenColors& colors_;
    Transmissions transmissions_;
    std::size_t count_, positions_;
    std::vector<glm::dvec3> points_;  // in the emitter's frame
    glm::dvec3 normal_{0.0};
    std::array<double, 3 * kMostBlock> rgb_{}, rgb_last_{};
    std::vector<double> first_, last_;  // transmissions at a block's ends
    std::vector<Lit> lit_;
    bool is_last_known_ = false;  // last_ belongs to the next block's first point
    LineLight result_;
};

// A seven-point rule on the unit disk of degree 5: the center and a hexagon.
// Source: Abramowitz and Stegun, "Handbook of mathematical functions", 25.4.61.
struct DiskNode {
    glm::dvec2 at{0.0};
    double weight = 0.0;
};

std::array<DiskNode, 7> disk_nodes() {
    std::array<DiskNode, 7> nodes;
    nodes[0] = {{0.0, 0.0}, 0.25};
    for (std::size_t k = 1; k < nodes.size(); ++k) {
        const double angle = static_cast<double>(k) * glm::pi<double>() / 3.0;
        nodes[k] = {std::sqrt(2.0 / 3.0) * glm::dvec2(std::cos(angle), std::sin(angle)), 0.125};
    }
    return nodes;
}

}  // namespace

LensLight make_lens_light(
    const Bench& bench, const Places& places, RayLamp lamp, double distance_m, double step) {
    LensLight light;
    light.bench = &bench;
    light.places = &places;
    light.bench_from_emitter = places.bench_from_lamp * lamp.lamp_from_emitter;
    const double per_pitch =
        has_jumps(bench.filter.profile) ? kNodesPerPitchOfJumps : kNodesPerPitch;
    const glm::dvec2 feature_m = lamp.feature_tangent * distance_m / kNodesPerFeature;
    const glm::dvec2 pitch_m = bench.filter.pitch_m / per_pitch;
    light.rows = aperture_rows(lamp.aperture, step * glm::min(feature_m, pitch_m));
    light.lamp = std::move(lamp);
    return light;
}

LineLight line_light(const LensLight& light,
                     std::span<const glm::dvec3> points_bench,
                     glm::dvec3 normal_bench,
                     const SeenColors& colors,
                     int position_count) {
    return LineIntegrator(light, points_bench, normal_bench, colors, position_count).integrate();
}

std::vector<double> hole_light(const LensLight& light,
                               std::span<const glm::dvec3> points_bench,
                               glm::dvec3 normal_bench,
                               const SeenColors& colors,
                               glm::dvec2 hole_filter_m) {
    const Rigid& bench_from_filter = light.places->bench_from_filter;
    const glm::dvec3 axis_bench = bench_from_filter.rotation[2];
    const double radius_m = light.bench->filter.hole_radius_m;
    const double area_m2 = glm::pi<double>() * radius_m * radius_m;
    std::vector<double> result(colors.size() * points_bench.size());
    for (const DiskNode& node : disk_nodes()) {
        const glm::dvec3 u_bench =
            apply(bench_from_filter, glm::dvec3(hole_filter_m + radius_m * node.at, 0.0));
        for (std::size_t i = 0; i < points_bench.size(); ++i) {
            const glm::dvec3 d = points_bench[i] - u_bench;
            const double square = glm::dot(d, d);
            const double weight = area_m2 * node.weight * std::max(0.0, glm::dot(d, axis_bench)) *
                                  std::max(0.0, -glm::dot(d, normal_bench)) / (square * square);
            const std::vector<double> seen = ray_light(light, u_bench, d, colors);
            for (std::size_t p = 0; p < colors.size(); ++p)
                result[p * points_bench.size() + i] += weight * seen[p];
        }
    }
    return result;
}

std::vector<double> ray_light(const LensLight& light,
                              glm::dvec3 through_bench,
                              glm::dvec3 direction_bench,
                              const SeenColors& colors) {
    std::vector<double> seen(colors.size(), 0.0);
    const Rigid emitter_from_bench = inverse(light.bench_from_emitter);
    const glm::dvec3 through = apply(emitter_from_bench, through_bench);
    const glm::dvec3 direction = emitter_from_bench.rotation * direction_bench;
    if (direction.z <= 0.0)
        return seen;
    const glm::dvec2 tangent = glm::dvec2(direction) / direction.z;
    const glm::dvec2 a_m = glm::dvec2(through) - through.z * tangent;
    const glm::dvec3 rgb = radiance(light.lamp, a_m, tangent);
    for (std::size_t p = 0; p < colors.size(); ++p)
        seen[p] = glm::dot(colors[p], rgb);
    return seen;
}

}  // namespace nearfield::sample_data

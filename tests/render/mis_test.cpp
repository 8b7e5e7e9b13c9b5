// SPDX-License-Identifier: Apache-2.0
#include "formats/model/profile.h"
#include "render/cpu/gloss.h"
#include "tests/render/scenes.h"
#include "tests/support/lamps.h"
#include "tests/support/oracle.h"
#include "tests/support/z_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace nearfield::render {
namespace {

/// A lamp, and a glossy receiver in its light, in the luminaire's frame.
struct Case {
    std::string name;
    LightField lightfield;
    Hit hit;
    glm::dvec3 to_viewer{0.0};
};

Hit hit_at(glm::dvec3 position_m, glm::dvec3 normal) {
    Hit hit;
    hit.position_world_m = position_m;
    hit.geometric_normal = hit.shading_normal = glm::normalize(normal);
    return hit;
}

LightField of_slabs(const std::vector<Slab>& slabs) {
    LightField lightfield;
    lightfield.slabs = slabs;
    return lightfield;
}

std::vector<Case> make_cases() {
    const Profile bspline = model::make_profile("bspline");
    const Hit near = hit_at({0.08, -0.03, 0.35}, {0.15, 0.05, -1});
    const glm::dvec3 viewer = glm::normalize(glm::dvec3(0.1, 0.2, -1));
    Slab lit = support::random_lamp(bspline, Weighting::Irradiance, 3);
    const float one = *std::max_element(lit.coeffs.begin(), lit.coeffs.end());
    std::fill(lit.coeffs.begin(), lit.coeffs.end(), 0.0F);
    // The texel through which the receiver sees the middle of an image's support.
    const glm::dvec2 u = lit.basis_center_m(2, 2);
    const glm::dvec2 s = u + (glm::dvec2(near.position_world_m) - u) *
                                 (lit.delta_m / (lit.delta_m + near.position_world_m.z));
    const glm::ivec2 texel((s - lit.s_min_m) / lit.texel_m());
    lit.coeffs[lit.image_offset(0, 2 * lit.grid.x + 2) +
               static_cast<std::size_t>(texel.y * lit.texels.x + texel.x)] = one;
    support::LampShape wide;
    wide.decades = 10;
    Slab second = support::random_lamp(bspline, Weighting::Irradiance, 6);
    second.luminaire_from_slab.rotation = support::rotation_about({0, 1, 0}, 0.2);
    second.luminaire_from_slab.translation_m = {-0.1, 0.02, 0.01};
    return {
        {"reference lamp", of_slabs({support::reference_lamp()}),
         hit_at({0.1, -0.15, 2.0}, {0.1, 0.1, -1}), glm::normalize(glm::dvec3(0.2, 0.1, -1))},
        {"one lit texel", of_slabs({lit}), near, viewer},
        {"range 1e10", of_slabs({support::random_lamp(bspline, Weighting::Irradiance, 4, wide)}),
         near, viewer},
        {"W != H, radiance weighting",
         of_slabs({support::random_lamp(bspline, Weighting::Radiance, 5)}), near, viewer},
        {"two slabs", of_slabs({support::random_lamp(bspline, Weighting::Irradiance, 5), second}),
         near, viewer},
    };
}

std::vector<shared::Brdf> make_brdfs() {
    std::vector<shared::Brdf> brdfs(5);
    for (std::uint32_t kind = 0; kind < 5; ++kind) {
        brdfs[kind].kind = kind;
        brdfs[kind].diffuse = glm::vec3(0.0F);
        brdfs[kind].specular = {0.7F, 0.5F, 0.3F};
        brdfs[kind].exponent = kind == shared::kBrdfPhong ? 400.0F : 100.0F;
        brdfs[kind].alpha = {0.08F, kind == shared::kBrdfWard ? 0.2F : 0.08F};
        brdfs[kind].cosines = {-0.9F, -0.9F, 1.0F};
    }
    return brdfs;
}

/// A direction to the lamp, and L cos dOmega there.
struct Node {
    glm::vec3 to_light{0.0F};
    glm::dvec3 light{0.0};
};

/// Edges on U along one axis between which the integrand is smooth: of cells and of texels as the
/// receiver sees them, and no wider than a fiftieth of the distance.
std::vector<double> smooth_edges(const Slab& slab, int axis, glm::dvec3 p_m) {
    const auto n = static_cast<int>(slab.profile.cells.size());
    const double distance = slab.delta_m + p_m.z;
    std::vector<double> edges;
    const double low = slab.basis_center_m(0, 0)[axis] - 0.5 * n * slab.pitch_m[axis];
    for (int c = 0; c <= slab.grid[axis] + n - 1; ++c)
        edges.push_back(low + c * slab.pitch_m[axis]);
    const double high = edges.back();
    for (int t = 0; t <= slab.texels[axis]; ++t) {
        const double s = slab.s_min_m[axis] + t * slab.texel_m()[axis];
        const double u = s + (s - p_m[axis]) * slab.delta_m / p_m.z;
        if (u > low && u < high)
            edges.push_back(u);
    }
    for (double u = low; u < high; u += 0.02 * distance)
        edges.push_back(u);
    std::sort(edges.begin(), edges.end());
    return edges;
}

/// Gauss' two points of every piece: exact for cubics.
std::vector<std::pair<double, double>> nodes_of(const std::vector<double>& edges) {
    std::vector<std::pair<double, double>> nodes;
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        const double half = 0.5 * (edges[i + 1] - edges[i]), middle = edges[i] + half;
        for (const double side : {-1.0, 1.0})
            if (half > 0.0)
                nodes.emplace_back(middle + side * half / std::sqrt(3.0), half);
    }
    return nodes;
}

void add_nodes(const Slab& slab, const Hit& hit, std::vector<Node>& nodes) {
    const Rigid& pose = slab.luminaire_from_slab;
    const glm::dvec3 p =
        glm::transpose(pose.rotation) * (hit.position_world_m - pose.translation_m);
    const shared::SurfaceFrame frame = shared::frame_from_normal(glm::vec3(hit.shading_normal));
    const double distance = slab.delta_m + p.z;
    for (const auto& [ux, wx] : nodes_of(smooth_edges(slab, 0, p)))
        for (const auto& [uy, wy] : nodes_of(smooth_edges(slab, 1, p))) {
            const glm::dvec2 u(ux, uy), s = u + (glm::dvec2(p) - u) * (slab.delta_m / distance);
            const glm::dvec3 radiance = support::oracle_radiance(slab, u, s);
            if (radiance == glm::dvec3(0.0))
                continue;
            const glm::dvec3 towards = glm::dvec3(u, -slab.delta_m) - p;
            const double r = glm::length(towards);
            const glm::dvec3 world = pose.rotation * (towards / r);
            nodes.push_back({shared::local_from_world(frame, glm::vec3(world)),
                             radiance * (glm::dot(world, hit.shading_normal) * distance /
                                         (r * r * r) * wx * wy)});
        }
}

double luminance(glm::dvec3 rgb) {
    return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
}

double reflected_y(const std::vector<Node>& nodes, const shared::Brdf& brdf, glm::vec3 to_viewer) {
    double sum = 0.0;
    for (const Node& node : nodes)
        sum +=
            luminance(node.light * glm::dvec3(shared::brdf_lobe(brdf, node.to_light, to_viewer)));
    return sum;
}

struct Moments {
    double count = 0, sum = 0, squares = 0;
    void add(double value) {
        ++count;
        sum += value;
        squares += value * value;
    }
    double z(double truth) const {
        const double mean = sum / count;
        const double variance = std::max(squares / count - mean * mean, 0.0) / (count - 1.0);
        return (mean - truth) / std::sqrt(variance);
    }
};

Lamps load(const Case& one, int index) {
    Scene scene;
    scene.luminaires = {
        test::write_lamp(one.lightfield, "mis" + std::to_string(index), glm::dmat4(1.0))};
    LampParts parts;
    parts.tables = true;
    return load_lamps(scene, parts);
}

/// What is held fixed while sets are drawn.
struct Receiver {
    const Case& one;
    const Lamps& lamps;
    const Tracer& tracer;
    const shared::Brdf& brdf;

    ShadeQuery query(int samples, std::uint32_t run) const {
        return {one.hit,
                one.to_viewer,
                brdf,
                shared::frame_from_normal(glm::vec3(one.hit.shading_normal)),
                {samples, 1},
                {run, 7U},
                0U,
                11U,
                model::Shift::Random};
    }
};

Moments run_shading(const Receiver& receiver, model::Sampler sampler, int samples, int runs) {
    model::SamplerOptions options;
    options.sampler = sampler;
    Scratch scratch;
    Moments moments;
    for (int run = 0; run < runs; ++run) {
        const ShadeQuery query = receiver.query(samples, static_cast<std::uint32_t>(run));
        moments.add(luminance(glm::dvec3(shade_sampled(receiver.lamps.lamps[0], receiver.tracer,
                                                       query, options, nullptr, 0, scratch)
                                             .radiance)));
    }
    return moments;
}

// Proves by z-tests over independent sets that multiple importance sampling of lamp and lobe is
// unbiased: five lamps, five lobes, 1 to 63 samples, against quadrature of the definition. Says
// nothing of shadows.
TEST(Mis, IsUnbiasedForEveryLobeAndNumberOfSamples) {
    const std::vector<Case> cases = make_cases();
    const std::vector<shared::Brdf> brdfs = make_brdfs();
    const std::vector<int> counts = {1, 2, 16, 63};
    const double limit =
        support::sidak_z_limit(static_cast<int>(cases.size() * brdfs.size() * counts.size()));
    const Tracer tracer({}, {}, 1);
    double worst = 0.0;
    for (std::size_t c = 0; c < cases.size(); ++c) {
        const Lamps lamps = load(cases[c], static_cast<int>(c));
        std::vector<Node> nodes;
        for (const Slab& slab : cases[c].lightfield.slabs)
            add_nodes(slab, cases[c].hit, nodes);
        for (const shared::Brdf& brdf : brdfs) {
            const Receiver receiver{cases[c], lamps, tracer, brdf};
            const double truth = reflected_y(nodes, brdf, to_viewer_local(receiver.query(1, 0)));
            ASSERT_GT(truth, 0.0) << cases[c].name;
            for (const int samples : counts) {
                const int runs = std::max(24000 / samples, 1200);
                const double z =
                    run_shading(receiver, model::Sampler::Systematic, samples, runs).z(truth);
                worst = std::max(worst, std::abs(z));
                EXPECT_LT(std::abs(z), limit)
                    << cases[c].name << ", lobe " << brdf.kind << ", K = " << samples;
            }
        }
    }
    RecordProperty("worst_z", std::to_string(worst));
}

/// Sets of 16, their lobe samples' weights with the lamp's density over `factor`.
Moments run_planted(const Receiver& receiver, float factor, int runs) {
    model::SamplerOptions options;
    options.samples = 16;
    const Lamp& lamp = receiver.lamps.lamps[0];
    Scratch scratch;
    scratch.views.resize(1);
    model::look(lamp.file->sampling[0], receiver_in_slab(lamp.slabs[0], receiver.one.hit), options,
                scratch.views[0]);
    const float total = scratch.views[0].total;
    Moments moments;
    for (int run = 0; run < runs; ++run) {
        const ShadeQuery query = receiver.query(options.samples, static_cast<std::uint32_t>(run));
        const GlossQuery right{lamp,    receiver.tracer, query,
                               options, total,           to_viewer_local(query)};
        GlossQuery planted = right;
        planted.lamp_total = total * factor;
        model::draw(lamp.file->sampling, scratch.views, options, shift_of_set(query, 0, 1U),
                    scratch.samples);
        glm::dvec3 sum(0.0);
        for (const model::LightSample& sample : scratch.samples) {
            const glm::dvec3 from(glm::dvec2(sample.u_m), -lamp.slabs[0].prepared->slab.delta_m);
            sum += glm::dvec3(sample.light) * weighted_lobe(right, scratch.views[0], sample,
                                                            from - query.hit.position_world_m);
        }
        sum += lobe_samples(planted, shift_of_set(query, 0, 2U), scratch) / 16.0;
        moments.add(luminance(sum));
    }
    return moments;
}

// Proves that the z-test has power: it rejects lobe samples whose weight takes the lamp's density
// per solid angle as p R^2 instead of p R^3 / (delta + Delta), on a receiver that sees the lamp at
// 45 degrees, and accepts the same sets without the error.
TEST(Mis, AWrongJacobianInOneOfTheWeightsIsRejected) {
    Case one = make_cases()[3];
    one.hit = hit_at({0.4, -0.03, 0.35}, {0.1, 0.0, -1});
    const glm::dvec3 to_lamp = glm::normalize(glm::dvec3(-0.4, 0.02, -0.55));
    one.to_viewer = glm::reflect(-to_lamp, one.hit.shading_normal);
    const Tracer tracer({}, {}, 1);
    const Lamps lamps = load(one, 9);
    std::vector<Node> nodes;
    add_nodes(one.lightfield.slabs[0], one.hit, nodes);
    const shared::Brdf brdf = make_brdfs()[shared::kBrdfGgx];
    const Receiver receiver{one, lamps, tracer, brdf};
    const double truth = reflected_y(nodes, brdf, to_viewer_local(receiver.query(1, 0)));
    constexpr int kRuns = 20000;
    EXPECT_LT(std::abs(run_planted(receiver, 1.0F, kRuns).z(truth)), support::sidak_z_limit(2));
    const double height = 0.35 + one.lightfield.slabs[0].delta_m;
    const double jacobians = std::hypot(height, 0.4) / height;
    EXPECT_GT(std::abs(run_planted(receiver, static_cast<float>(jacobians), kRuns).z(truth)),
              support::sidak_z_limit(2));
}

}  // namespace
}  // namespace nearfield::render

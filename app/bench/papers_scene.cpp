// SPDX-License-Identifier: Apache-2.0
#include "app/bench/papers_scene.h"

#include "formats/files/provenance.h"
#include "formats/model/tables.h"
#include "render/cpu/render.h"
#include "render/film.h"
#include "sample_data/demo_scene.h"
#include "sample_data/simulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>

namespace nearfield::bench {
namespace {

// Near enough that a pixel sees windows of some twenty texels, as near-field lamps are measured;
// nothing that the cameras see lies on S.
constexpr double kDelta_m = 0.5;
constexpr int kTimedBuilds = 3;

struct LampSizes {
    const char *name, *paper, *basis;
    glm::ivec2 grid, texels, quick_texels;
};

constexpr std::array<LampSizes, 3> kLamps = {{
    {"9x7", "bike", "quadratic", {9, 7}, {300, 300}, {36, 36}},
    {"5x5", "car1", "bspline", {5, 5}, {256, 256}, {32, 32}},
    {"11x9", "car2", "bspline", {11, 9}, {256, 256}, {32, 32}},
}};

template <typename T>
double bytes(const std::vector<T>& values) {
    return static_cast<double>(values.size() * sizeof(T));
}

double bytes(const SlabTables& tables) {
    double sum = bytes(tables.total) + bytes(tables.median_s_m) + bytes(tables.sat_hi) +
                 bytes(tables.sat_lo) + bytes(tables.marginal_cdf) + bytes(tables.conditional_cdf) +
                 bytes(tables.cell_reference_s_m) + bytes(tables.cell_total);
    for (const MipLevel& level : tables.mips)
        sum += bytes(level.coeffs);
    return sum;
}

PapersLamp make_papers_lamp(const LampSizes& sizes, const std::string& folder, bool quick) {
    sample_data::SimulateOptions options;
    options.delta_m = kDelta_m;
    options.grid = sizes.grid;
    options.texels = quick ? sizes.quick_texels : sizes.texels;
    options.basis = sizes.basis;
    PapersLamp lamp;
    lamp.name = sizes.name;
    lamp.paper = sizes.paper;
    lamp.uri = fmt::format("{}.lightfield.exr", sizes.name);
    lamp.lightfield = sample_data::simulate_headlight(options, {}).lightfield;
    write_lightfield(lamp.lightfield, std::nullopt,
                     (std::filesystem::path(folder) / lamp.uri).string());
    const Slab& slab = lamp.lightfield.slabs.front();
    lamp.coefficient_bytes = bytes(slab.coeffs);
    lamp.tables_s = std::numeric_limits<double>::infinity();
    for (int k = 0; k < kTimedBuilds; ++k) {
        const double start_s = now_s();
        const SlabTables tables = model::build_tables(slab);
        lamp.tables_s = std::min(lamp.tables_s, now_s() - start_s);
        lamp.table_bytes = bytes(tables);
    }
    return lamp;
}

}  // namespace

std::vector<PapersLamp> make_papers_lamps(const std::string& folder, bool quick) {
    std::vector<PapersLamp> lamps;
    lamps.reserve(kLamps.size());
    for (const LampSizes& sizes : kLamps)
        lamps.push_back(make_papers_lamp(sizes, folder, quick));
    return lamps;
}

Scene make_papers_scene(const PapersLamp& lamp, const std::string& folder, int lamps) {
    Scene scene =
        sample_data::make_demo_scene(lamp.uri, (std::filesystem::path(folder) / lamp.uri).string(),
                                     lamp.lightfield.slabs.front().delta_m);
    scene.luminaires.resize(static_cast<std::size_t>(lamps));
    return scene;
}

View make_view(const Scene& scene,
               const std::string& camera_name,
               glm::ivec2 size_px,
               const Lamp& lamp) {
    render::RenderOptions options;
    options.camera = camera_name;
    options.size_px = size_px;
    options.effects = {render::Switch::Off, render::Switch::Off, render::Switch::Off,
                       render::Switch::Off};
    const Picture picture = render::render_cpu(scene, options).picture;
    const std::vector<float>& depths_m = picture.layers[render::kDepth].values;
    const std::vector<float>& normals = picture.layers[render::kNormal].values;
    const Camera& camera = render::find_camera(scene, camera_name);
    const glm::dvec3 axis = -glm::normalize(glm::dvec3(camera.world_from_camera[2]));
    const glm::dmat4 luminaire_from_world =
        glm::inverse(scene.luminaires.front().world_from_luminaire);

    std::vector<model::Receiver> receivers;
    const model::Receiver unseen{{0.0, 0.0, -10.0}, {0.0, 0.0, -1.0}};
    for (int y = size_px.y - 1; y >= 0; --y)
        for (int x = 0; x < size_px.x; ++x) {
            const auto k = static_cast<std::size_t>(y * size_px.x + x);
            const auto depth_m = static_cast<double>(depths_m[k]);
            if (!(depth_m > 0.0)) {
                receivers.push_back(unseen);
                continue;
            }
            const glm::dvec3 ray =
                render::camera_ray(camera, size_px, glm::dvec2(x, y) + glm::dvec2(0.5));
            const glm::dvec3 position_m =
                glm::dvec3(camera.world_from_camera[3]) + ray * (depth_m / glm::dot(ray, axis));
            const glm::dvec3 normal(normals[3 * k], normals[3 * k + 1], normals[3 * k + 2]);
            receivers.push_back({glm::dvec3(luminaire_from_world * glm::dvec4(position_m, 1.0)),
                                 glm::dmat3(luminaire_from_world) * normal});
        }
    const double start_s = now_s();
    View view{camera_name, make_target(lamp, receivers, size_px), 0.0};
    view.exact_s = now_s() - start_s;
    return view;
}

}  // namespace nearfield::bench

// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/refine.h"

#include "app/viewer/worker.h"
#include "formats/files/provenance.h"
#include "render/film.h"
#include "render/seen_lamps.h"

#include <algorithm>
#include <utility>

namespace nearfield::viewer {
namespace {

constexpr std::size_t kMostKept = 3;  // drafts, halves and pictures of one view

/// A name that no camera of a file has.
const std::string kCameraName = "the viewer's";

/// What is rendered: the request's scene from its camera, lamps without tint (mixing adds it).
Scene scene_of(const Request& request) {
    Scene scene = edited_scene(request.document);
    for (LuminaireInstance& luminaire : scene.luminaires)
        luminaire.tint = glm::vec3(1.0F);
    Camera camera = request.camera;
    camera.name = kCameraName;
    scene.cameras = {camera};
    return scene;
}

/// Times of lamps add; what passes hold is there once.
void add_costs(const std::vector<render::PassReport>& of_others,
               std::vector<render::PassReport>& costs) {
    for (render::PassReport& cost : costs)
        for (const render::PassReport& other : of_others)
            if (other.id == cost.id) {
                cost.time_s += other.time_s;
                cost.bytes = std::max(cost.bytes, other.bytes);
            }
}

}  // namespace

const Refiner::Kept* Refiner::find(const Request& request, const Quality& quality) const {
    const auto found =
        std::find_if(kept_.begin(), kept_.end(), [&](const std::unique_ptr<Kept>& one) {
            return one->quality == quality && one->size_px == request.size_px &&
                   one->scene == request.document.scene &&
                   one->camera.world_from_camera == request.camera.world_from_camera &&
                   one->camera.yfov_rad == request.camera.yfov_rad;
        });
    return found == kept_.end() ? nullptr : found->get();
}

Refiner::Kept& Refiner::keep(const Request& request, const Quality& quality) {
    const Kept* found = find(request, quality);
    const auto place = std::find_if(kept_.begin(), kept_.end(),
                                    [&](const auto& one) { return one.get() == found; });
    if (place != kept_.end()) {
        std::rotate(kept_.begin(), place, place + 1);
        return *kept_.front();
    }
    auto fresh = std::make_unique<Kept>();
    fresh->scene = request.document.scene;
    fresh->camera = request.camera;
    fresh->quality = quality;
    fresh->size_px = request.size_px;
    kept_.insert(kept_.begin(), std::move(fresh));
    kept_.resize(std::min(kept_.size(), kMostKept));
    return *kept_.front();
}

bool Refiner::has(const Request& request, const Quality& quality) const {
    const Kept* kept = find(request, quality);
    if (kept == nullptr || kept->frame.depth_m.empty())
        return false;
    return std::all_of(request.document.lamps.begin(), request.document.lamps.end(),
                       [&](const EditedLamp& lamp) {
                           const auto known = kept->rendered.find(lamp.id);
                           return !is_lit(lamp) ||
                                  (known != kept->rendered.end() && is_alike(lamp, known->second));
                       });
}

void Refiner::render_lamp(const Scene& scene,
                          std::optional<std::size_t> lamp,
                          const Request& request,
                          const render::RenderHooks& hooks,
                          Kept& kept) {
    render::RenderOptions options = options_of(kept.quality, request.size_px);
    options.camera = kCameraName;
    render::Rendered rendered =
        session_.render(scene, options, render::begin_call(options, hooks), lamp);
    std::vector<Layer>& layers = rendered.picture.layers;
    Frame& frame = kept.frame;
    frame.size_px = rendered.picture.size_px;
    frame.depth_m = std::move(layers[render::kDepth].values);
    frame.quantity = rendered.report.quantity;
    if (has_rendered_)
        add_costs(frame.report.costs, rendered.report.costs);
    frame.report = std::move(rendered.report);
    has_rendered_ = true;
    if (!lamp)
        return;
    const EditedLamp& edited = request.document.lamps[*lamp];
    auto light = std::make_shared<LampLight>();
    light->lamp = edited.id;
    light->dim = edited.luminaire.dim;
    const auto lit_before = static_cast<std::size_t>(
        std::count_if(request.document.lamps.begin(),
                      request.document.lamps.begin() + static_cast<std::ptrdiff_t>(*lamp), is_lit));
    light->radiance = std::move(layers[render::kFirstLamp + lit_before].values);
    light->irradiance = std::move(layers[render::kIrradiance].values);
    light->sigma = std::move(layers[render::kSigma].values);
    const auto seen = render::find_layer(rendered.picture, render::kSeenLamps);
    if (std::any_of(layers[*seen].values.begin(), layers[*seen].values.end(),
                    [](float value) { return value > 0.0F; }))
        light->seen = std::move(layers[*seen].values);
    if (const auto bias = render::find_layer(rendered.picture, "bias_bound"))
        light->bias = std::move(layers[*bias].values);
    kept.lights[edited.id] = std::move(light);
    kept.rendered.insert_or_assign(edited.id, edited);
}

Frame Refiner::render(const Request& request,
                      const Quality& quality,
                      const std::function<bool()>& is_stopped) {
    const double start_s = now_s();
    has_rendered_ = false;
    Kept& kept = keep(request, quality);
    render::RenderHooks hooks;
    hooks.is_stopped = is_stopped;
    std::optional<Scene> scene;
    const std::vector<EditedLamp>& lamps = request.document.lamps;
    kept.frame.lamps.clear();
    for (std::size_t k = 0; k < lamps.size(); ++k) {
        if (!is_lit(lamps[k]))
            continue;
        const auto known = kept.rendered.find(lamps[k].id);
        if (known == kept.rendered.end() || !is_alike(lamps[k], known->second)) {
            if (!scene)
                scene = scene_of(request);
            render_lamp(*scene, k, request, hooks, kept);
        }
        kept.frame.lamps.push_back(kept.lights.at(lamps[k].id));
    }
    if (kept.frame.depth_m.empty())  // no lamp is lit
        render_lamp(scene_of(request), std::nullopt, request, hooks, kept);
    std::erase_if(kept.lights, [&](const auto& light) {
        return find_lamp(request.document, light.first) == nullptr;
    });
    std::erase_if(kept.rendered, [&](const auto& lamp) {
        return find_lamp(request.document, lamp.first) == nullptr;
    });
    kept.frame.camera = request.camera;
    kept.frame.quality = quality;
    kept.frame.time_s = now_s() - start_s;
    kept.frame.serial = request.serial;
    return kept.frame;
}

}  // namespace nearfield::viewer

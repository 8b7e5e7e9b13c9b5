// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/session.h"

#include "formats/files/error.h"
#include "formats/files/provenance.h"
#include "render/film.h"
#include "render/gpu/frame_report.h"
#include "render/gpu/headless.h"
#include "render/gpu/passes.h"
#include "render/materials.h"
#include "render/seen_lamps.h"

#include <algorithm>
#include <list>
#include <thread>
#include <utility>

namespace nearfield::render::gpu {
namespace {

// Of sizes and variants: what interactive work goes back and forth between.
constexpr std::size_t kMostTargets = 4, kMostVariants = 4;

/// What is drawn into, of one size.
struct Target {
    SurfacePass surfaces;
    Film film;
    bool has_bias = false;
    std::uint64_t surface_bytes = 0;
};

/// What programs are compiled for.
struct Variant {
    bool has_color, has_gloss, has_tangents, any_with_shadows, any_without;
    std::optional<model::Sampler> sampler;
    std::optional<model::Sequence> sequence;
    model::Shift shift;
    int pcf_taps;
    ShadowWeights shadow_weights;

    bool operator==(const Variant&) const = default;
};

Variant variant_of(const Plan& plan, const RenderOptions& options, bool has_tangents) {
    Variant variant{plan.color.is_in,
                    plan.has_gloss,
                    has_tangents,
                    false,
                    false,
                    options.sampler,
                    options.sequence,
                    options.shift,
                    options.shadow_maps.pcf_taps,
                    options.shadow_weights};
    for (const LampPlan& lamp : plan.lamps) {
        variant.any_with_shadows |= lamp.is_lit && lamp.has_shadows;
        variant.any_without |= lamp.is_lit && !lamp.has_shadows;
    }
    return variant;
}

bool is_same(const Instance& a, const Instance& b) {
    return a.mesh == b.mesh && a.world_from_mesh == b.world_from_mesh;
}

bool is_same(const Mesh& a, const Mesh& b) {
    return a.material == b.material && a.positions_m == b.positions_m && a.normals == b.normals &&
           a.tangents == b.tangents && a.triangles == b.triangles;
}

bool are_glossy_alike(const Material& a, const Material& b) {
    return shared::brdf_is_glossy(brdf(a)) == shared::brdf_is_glossy(brdf(b));
}

template <typename T, typename Same>
bool are_same(const std::vector<T>& a, const std::vector<T>& b, const Same& same) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

/// Of what upload_scene reads.
bool is_same_geometry(const Scene& a, const Scene& b) {
    const auto same = [](const auto& one, const auto& other) { return is_same(one, other); };
    return are_same(a.instances, b.instances, same) && are_same(a.meshes, b.meshes, same) &&
           are_same(a.materials, b.materials, are_glossy_alike);
}

/// Puts what `fits` first, made if it is not there, and drops the last of too many.
template <typename T, typename Fits, typename Make>
T& use(std::list<T>& kept, std::size_t most, const Fits& fits, const Make& make) {
    const auto found = std::find_if(kept.begin(), kept.end(), fits);
    if (found != kept.end())
        kept.splice(kept.begin(), kept, found);
    else
        kept.push_front(make());
    if (kept.size() > most)
        kept.pop_back();
    return kept.front();
}

/// The luminaire's place among the lamps that are loaded: those that are on.
std::size_t lamp_of(const Scene& scene, std::size_t luminaire) {
    const auto end = scene.luminaires.begin() + static_cast<std::ptrdiff_t>(luminaire);
    return static_cast<std::size_t>(
        std::count_if(scene.luminaires.begin(), end,
                      [](const LuminaireInstance& one) { return one.on && one.dim > 0.0; }));
}

/// A call's stop, for the device; without it once the call is over.
class StopScope {
  public:
    StopScope(Device& device, const RenderHooks& hooks) : device_(device) {
        device_.set_stop(hooks.is_stopped);
    }
    ~StopScope() { device_.set_stop({}); }
    StopScope(const StopScope&) = delete;
    StopScope& operator=(const StopScope&) = delete;

  private:
    Device& device_;
};

}  // namespace

struct Session::Kept {
    HeadlessContext context;
    Device device;
    KeptFiles files;
    Scene geometry;  // that scene_buffers hold
    std::optional<SceneBuffers> scene_buffers;
    LampsOnCard on_card;
    ShadowPass shadow_pass = make_shadow_pass();
    SkyKept sky;
    std::list<Target> targets;
    std::list<std::pair<Variant, LightPasses>> variants;
    // Of on_card.shadows; and those of other options, since drafts alternate with pictures.
    ShadowMapOptions shadow_options, other_shadow_options;
    std::vector<ShadowMaps> other_shadows;

    void use_scene(const Scene& scene, const std::vector<shared::Brdf>& brdfs) {
        if (!scene_buffers || !is_same_geometry(scene, geometry)) {
            scene_buffers = upload_scene(device, scene);
            geometry = {scene.materials, scene.meshes, scene.instances, {}, {}, {}, {}};
        }
        scene_buffers->materials = upload_materials(device, brdfs);
    }

    Target& use_target(glm::ivec2 size_px, std::size_t lamps, bool has_bias, bool has_turns) {
        return use(
            targets, kMostTargets,
            [&](const Target& one) {
                return one.film.size_px == size_px && one.film.of_lamp.size() == lamps &&
                       one.has_bias == has_bias && one.surfaces.surfaces.has_turns == has_turns &&
                       one.surfaces.has_tangents == scene_buffers->has_tangents;
            },
            [&] {
                const std::uint64_t before = device.allocated_bytes();
                SurfacePass surfaces =
                    make_surface_pass(device, *scene_buffers, size_px, has_turns);
                const std::uint64_t bytes = device.allocated_bytes() - before;
                return Target{std::move(surfaces), make_film(device, size_px, lamps, has_bias),
                              has_bias, bytes};
            });
    }

    void use_shadows(const ShadowMapOptions& options, std::size_t lamps) {
        if (!(options == shadow_options)) {
            std::swap(on_card.shadows, other_shadows);
            std::swap(shadow_options, other_shadow_options);
        }
        if (!(options == shadow_options))
            on_card.shadows.clear();
        shadow_options = options;
        on_card.shadows.resize(lamps);
    }

    LightPasses& use_passes(const Plan& plan, const RenderOptions& options) {
        const Variant variant = variant_of(plan, options, scene_buffers->has_tangents);
        return use(
                   variants, kMostVariants, [&](const auto& one) { return one.first == variant; },
                   [&] {
                       return std::pair(
                           variant, make_light_passes(device, plan, options, variant.has_tangents));
                   })
            .second;
    }
};

Session::Session() : kept_(std::make_unique<Kept>()) {}
Session::~Session() = default;

std::uint64_t Session::allocated_bytes() const {
    return kept_->device.allocated_bytes();
}

Rendered Session::render(const Scene& scene,
                         const RenderOptions& options,
                         const Call& call,
                         std::optional<std::size_t> only) {
    Device& device = kept_->device;
    const StopScope stop(device, call.hooks);
    device.clear_costs();
    Rendered result;
    RenderReport& report = result.report;
    report.device = device.renderer();
    report.threads = static_cast<int>(std::thread::hardware_concurrency());
    const Opening opening = open_scene(scene, options, render::Device::Gl, kept_->files, report);
    const Lamps& lamps = opening.lamps;
    const Plan& plan = report.plan;
    const bool has_bias = !options.sampler && options.q > 0 && options.has_bias_bound;
    result.picture = make_picture(lamps, opening.size_px, {plan.has_environment, false});
    if (has_bias)
        add_bias_layer(result.picture);

    const double build_start_s = now_s();
    std::vector<shared::Brdf> brdfs;
    for (const Material& material : scene.materials)
        brdfs.push_back(planned_brdf(material, plan));
    kept_->use_scene(scene, brdfs);
    upload_lamps(device, lamps, plan, options, kept_->on_card);
    report.lamp_bytes = static_cast<double>(kept_->on_card.sum_bytes + kept_->on_card.table_bytes);
    const std::size_t lights = lamps.lamps.size() + (opening.sky ? 1 : 0);
    Target& target =
        kept_->use_target(opening.size_px, lights, has_bias, counts_by_turns(plan, options));
    clear(target.film);
    GlFrame frame{scene,
                  options,
                  opening,
                  plan,
                  device,
                  *kept_->scene_buffers,
                  target.surfaces,
                  kept_->on_card,
                  kept_->use_passes(plan, options),
                  target.film};
    if (only)
        frame.only_lamp = lamp_of(scene, *only);
    report.build_s = now_s() - build_start_s;

    kept_->use_shadows(options.shadow_maps, lamps.lamps.size());
    draw_shadow_maps(frame, kept_->shadow_pass);
    if (opening.sky && !only) {
        prepare_sky(device, *opening.sky, plan, options, *kept_->scene_buffers, opening.size_px,
                    kept_->sky);
        frame.sky = &kept_->sky;
    }
    add_passes(frame, call, result.picture, report);
    read_surfaces(target.surfaces.surfaces, brdfs, result.picture);
    if (options.shows_lamps)
        add_seen_lamps(opening, options, frame.only_lamp, result.picture);
    report_costs(frame, target.surface_bytes, report);
    report.q = options.sampler ? 0 : options.q;
    end_call(call, options, report);
    return result;
}

}  // namespace nearfield::render::gpu

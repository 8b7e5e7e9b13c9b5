// SPDX-License-Identifier: Apache-2.0
#include "render/sky.h"

#include "formats/files/provenance.h"
#include "formats/shared/filtered_samples.glsl.h"

#include <chrono>
#include <filesystem>

namespace nearfield::render {
namespace {

environment::Parts parts_of(const Plan& plan, const EnvironmentOptions& options) {
    const bool is_filtered = options.method == EnvironmentMethod::Filtered;
    environment::Parts parts;
    parts.table = plan.draws_sky;
    parts.maps = is_filtered && has_pass(plan, PassId::EnvironmentSamples);
    parts.harmonics = is_filtered && has_pass(plan, PassId::EnvironmentIrradiance);
    if ((is_filtered && hides_sky(plan)) || options.method == EnvironmentMethod::Lights)
        parts.directions = options.directions;
    parts.suns = is_filtered ? options.suns : 0;
    parts.is_gray = plan.color.is_removed;
    return parts;
}

std::int64_t modified_ns(const std::string& path) {
    std::error_code failed;  // reading will say why
    const auto written = std::filesystem::last_write_time(path, failed);
    return std::chrono::duration_cast<std::chrono::nanoseconds>(written.time_since_epoch()).count();
}

}  // namespace

std::optional<Sky> load_sky(const Scene& scene,
                            const Plan& plan,
                            const EnvironmentOptions& options,
                            SkyFile& kept) {
    if (!plan.has_environment)
        return std::nullopt;
    const SceneEnvironment& around = *scene.environment;
    const environment::Parts parts = parts_of(plan, options);
    const std::int64_t written_ns = modified_ns(around.path);
    const double start_s = now_s();
    if (kept.environment == nullptr || kept.path != around.path || !(kept.parts == parts) ||
        kept.modified_ns != written_ns)
        kept = {around.path, written_ns, parts,
                std::make_shared<environment::Environment>(
                    environment::prepare(environment::read_latlong(around.path), parts))};
    Sky sky;
    sky.environment = kept.environment;
    sky.environment_from_world = glm::mat3(glm::transpose(around.world_from_environment));
    sky.intensity = static_cast<float>(around.intensity);
    sky.load_s = now_s() - start_s;
    return sky;
}

bool counts_by_turns(const Plan& plan, const RenderOptions& options) {
    return options.environment.error_rel > 0.0 && options.samples_per_pixel > 1 &&
           options.environment.method == EnvironmentMethod::Filtered &&
           has_pass(plan, PassId::EnvironmentSamples);
}

std::uint32_t word_of(FilterLevel level) {
    switch (level) {
        case FilterLevel::Gems:
            return shared::kLevelGems;
        case FilterLevel::None:
            return shared::kLevelNone;
        case FilterLevel::Mfis:
            return shared::kLevelMfis;
        default:
            return shared::kLevelFis;
    }
}

glm::vec3 radiance_from(const Sky& sky, glm::vec3 direction_world) {
    return sky.intensity *
           environment::radiance(sky.environment->picture, sky.local(direction_world));
}

}  // namespace nearfield::render

// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/sky_textures.h"

#include "render/gpu/storage.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace nearfield::render::gpu {
namespace {

// Bindings of sky.glsl and of sky_samples.comp, sky_past.comp, sky_visibility.comp.
constexpr GLuint kBlock = 2, kSuns = 4, kDirections = 5, kFit = 7;
constexpr GLuint kPicture = 4, kMaps = 5, kMapsWithSuns = 8;

// As std140 lays SkyBlock of sky.glsl out.
struct SkyBlock {
    glm::mat4 environment_from_world;
    std::array<glm::vec4, 16> harmonics;
    glm::vec4 intensity_sun;
    glm::ivec4 counts;
};
static_assert(sizeof(SkyBlock) == 64 + 256 + 32);

std::vector<glm::vec4> with_alpha(const std::vector<glm::vec3>& rgb) {
    std::vector<glm::vec4> rgba;
    rgba.reserve(rgb.size());
    for (const glm::vec3& value : rgb)
        rgba.emplace_back(value, 0.0F);
    return rgba;
}

Texture upload_picture(Device& device, const environment::LatLong& picture) {
    Texture texture = make_texture(device, "the environment", GL_RGBA32F, picture.size_px);
    upload(texture, picture.size_px, 4, &with_alpha(picture.radiance).front()[0]);
    return texture;
}

Texture upload_maps(Device& device, const environment::ParaboloidMap& map) {
    Texture texture =
        make_mipped_array(device, "the environment's maps", GL_RGBA32F, map.side_px(), 2);
    for (std::size_t level = 0; level < map.levels.size(); ++level)
        for (std::size_t side = 0; side < 2; ++side)
            upload_level(texture, static_cast<int>(level), map.levels[level].side_px,
                         static_cast<int>(side), &map.levels[level].sides.at(side).front()[0]);
    return texture;
}

Buffer upload_suns(Device& device, const environment::Suns& suns) {
    std::vector<glm::vec4> values;
    for (const environment::Sun& sun : suns.suns) {
        values.emplace_back(sun.direction, 0.0F);
        values.emplace_back(sun.irradiance, 0.0F);
    }
    return make_buffer_of(device, values, "the environment's suns");
}

void upload_directions(Device& device, const environment::VisibilityFit& fit, SkyOnCard& on_card) {
    std::vector<glm::vec4> values;
    for (std::size_t n = 0; n < fit.directions.size(); ++n) {
        values.emplace_back(fit.directions[n], 0.0F);
        values.emplace_back(fit.light[n], 0.0F);
    }
    on_card.directions = make_buffer_of(device, values, "the environment's directions");
    on_card.fit = make_buffer_of(device, fit.fit, "the environment's directions");
}

SkyBlock block_of(const Sky& sky, const RenderOptions& options) {
    SkyBlock block{
        glm::mat4(sky.environment_from_world),
        {},
        glm::vec4(sky.intensity, 0.0F, static_cast<float>(options.environment.error_rel), 0.0F),
        glm::ivec4(options.environment.samples, 0, 0, options.samples_per_pixel)};
    if (const auto& harmonics = sky.environment->harmonics)
        std::transform(harmonics->radiance.begin(), harmonics->radiance.end(),
                       block.harmonics.begin(), [](glm::vec3 rgb) { return glm::vec4(rgb, 0.0F); });
    if (const auto& suns = sky.environment->suns) {
        block.intensity_sun.y = suns->radius_rad;
        block.counts.z = static_cast<int>(suns->suns.size());
    }
    if (const auto& asked = sky.environment->directions)
        block.counts.y = static_cast<int>(asked->directions.size());
    return block;
}

}  // namespace

void upload_sky(Device& device, const Sky& sky, const RenderOptions& options, SkyOnCard& on_card) {
    if (on_card.environment != sky.environment) {
        const std::uint64_t before = device.allocated_bytes();
        on_card = {};
        on_card.picture = upload_picture(device, sky.environment->picture);
        if (sky.environment->maps)
            on_card.maps = upload_maps(device, *sky.environment->maps);
        if (sky.environment->maps_with_suns)
            on_card.maps_with_suns = upload_maps(device, *sky.environment->maps_with_suns);
        on_card.suns = upload_suns(device, sky.environment->suns.value_or(environment::Suns{}));
        upload_directions(
            device, sky.environment->directions.value_or(environment::VisibilityFit{}), on_card);
        on_card.block = make_zero_buffer(device, sizeof(SkyBlock), "the environment's place");
        on_card.environment = sky.environment;
        on_card.bytes = device.allocated_bytes() - before;
    }
    const SkyBlock block = block_of(sky, options);
    glNamedBufferSubData(on_card.block.id(), 0, sizeof(block), &block);
    device.check("upload of the environment");
}

void bind_sky(const SkyOnCard& on_card) {
    glBindBufferBase(GL_UNIFORM_BUFFER, kBlock, on_card.block.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kDirections, on_card.directions.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kFit, on_card.fit.id());
    glBindTextureUnit(kPicture, on_card.picture.id());
    glBindTextureUnit(kMaps, on_card.maps.id());
    glBindTextureUnit(kMapsWithSuns, on_card.maps_with_suns.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kSuns, on_card.suns.id());
}

}  // namespace nearfield::render::gpu

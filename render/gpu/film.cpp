// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/film.h"

#include "formats/model/mip_sum.h"
#include "render/film.h"
#include "render/gpu/shader.h"
#include "render/gpu/storage.h"

#include <algorithm>
#include <cmath>

namespace nearfield::render::gpu {
namespace {

void clear_texture(const Texture& texture) {
    glClearTexImage(texture.id(), 0, GL_RGBA, GL_FLOAT, nullptr);
}

void bind_image(GLuint unit, const Texture& texture, GLenum access, GLenum format = GL_RGBA32F) {
    glBindImageTexture(unit, texture.id(), 0, GL_FALSE, 0, access, format);
}

void copy_rgb(const std::vector<float>& rgba, float scale, Layer& layer) {
    for (std::size_t k = 0; 3 * k < layer.values.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c)
            layer.values[3 * k + c] = scale * rgba[4 * k + c];
}

}  // namespace

Film make_film(Device& device, glm::ivec2 size_px, std::size_t lamps, bool has_bias) {
    const auto make = [&](GLenum format = GL_RGBA32F) {
        return make_texture(device, "the picture", format, size_px);
    };
    Film film;
    film.size_px = size_px;
    film.lamp_light = make();
    film.lamp_irradiance = make();
    film.radiance = make();
    film.irradiance = make();
    for (std::size_t k = 0; k < lamps; ++k)
        film.of_lamp.push_back(make());
    if (has_bias) {
        film.finer_light = make();
        film.finer_irradiance = make();
        film.bias = make(GL_R32F);
        film.add_bias = link_compute("render/shaders/bias.comp");
    }
    film.accumulate = link_compute("render/shaders/accumulate.comp");
    film.tonemap = link_compute("render/shaders/tonemap.comp");
    clear(film);
    return film;
}

void clear(Film& film) {
    clear_texture(film.radiance);
    clear_texture(film.irradiance);
    for (const Texture& of_lamp : film.of_lamp)
        clear_texture(of_lamp);
    if (film.bias)
        clear_texture(film.bias);
    film.weight = 0.0F;
    film.weight_squares = 0.0F;
}

void begin_lamp(const Film& film) {
    clear_texture(film.lamp_light);
    clear_texture(film.lamp_irradiance);
    bind_image(0, film.lamp_light, GL_READ_WRITE);
    bind_image(1, film.lamp_irradiance, GL_READ_WRITE);
}

void begin_finer(const Film& film) {
    clear_texture(film.finer_light);
    clear_texture(film.finer_irradiance);
    bind_image(0, film.finer_light, GL_READ_WRITE);
    bind_image(1, film.finer_irradiance, GL_READ_WRITE);
}

void end_finer(const Film& film, float weight) {
    bind_image(0, film.lamp_light, GL_READ_ONLY);
    bind_image(1, film.finer_light, GL_READ_ONLY);
    bind_image(2, film.bias, GL_READ_WRITE, GL_R32F);
    glProgramUniform1f(film.add_bias.id(), 0, model::kBiasPerDifference * weight);
    dispatch_2d(film.add_bias, film.size_px.x, film.size_px.y);
    bind_image(0, film.lamp_light, GL_READ_WRITE);
    bind_image(1, film.lamp_irradiance, GL_READ_WRITE);
}

void end_lamp(Film& film, std::size_t lamp, float weight) {
    bind_image(0, film.lamp_light, GL_READ_ONLY);
    bind_image(1, film.lamp_irradiance, GL_READ_ONLY);
    bind_image(2, film.radiance, GL_READ_WRITE);
    bind_image(3, film.irradiance, GL_READ_WRITE);
    bind_image(4, film.of_lamp[lamp], GL_READ_WRITE);
    glProgramUniform1f(film.accumulate.id(), 0, weight);
    dispatch_2d(film.accumulate, film.size_px.x, film.size_px.y);
}

void end_pass(Film& film, float weight) {
    film.weight += weight;
    film.weight_squares += weight * weight;
}

void read_film(const Film& film, float root, Picture& picture) {
    const float scale = film.weight > 0.0F ? 1.0F / film.weight : 0.0F;
    const std::vector<float> radiance = read_back(film.radiance, film.size_px, 4);
    copy_rgb(radiance, scale, picture.layers[kRadiance]);
    std::vector<float>& sigma = picture.layers[kSigma].values;
    for (std::size_t k = 0; k < sigma.size(); ++k)
        sigma[k] = root * scale * std::sqrt(std::max(radiance[4 * k + 3], 0.0F));
    copy_rgb(read_back(film.irradiance, film.size_px, 4), scale, picture.layers[kIrradiance]);
    for (std::size_t lamp = 0; lamp < film.of_lamp.size(); ++lamp)
        copy_rgb(read_back(film.of_lamp[lamp], film.size_px, 4), scale,
                 picture.layers[kFirstLamp + lamp]);
    if (!film.bias)
        return;
    std::vector<float>& bias = picture.layers.back().values;
    bias = read_back(film.bias, film.size_px, 1);
    for (float& value : bias)
        value *= scale;
}

Texture tone_map(Device& device, const Film& film, ToneMap operation, double exposure_ev) {
    Texture srgb = make_texture(device, "the displayed picture", GL_RGBA8, film.size_px);
    bind_image(0, film.radiance, GL_READ_ONLY);
    bind_image(1, srgb, GL_WRITE_ONLY, GL_RGBA8);
    const GLuint program = film.tonemap.id();
    glProgramUniform1f(program, 0, film.weight > 0.0F ? 1.0F / film.weight : 0.0F);
    glProgramUniform1f(program, 1, static_cast<float>(white_of(exposure_ev)));
    glProgramUniform1i(program, 2, operation == ToneMap::Papers ? 1 : 0);
    dispatch_2d(film.tonemap, film.size_px.x, film.size_px.y);
    return srgb;
}

}  // namespace nearfield::render::gpu

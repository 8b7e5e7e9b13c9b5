// SPDX-License-Identifier: Apache-2.0
#include "tests/render/sky_scenes.h"

#include "tests/environment/skies.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nearfield::test {

SceneEnvironment write_sky(const environment::LatLong& picture, const std::string& name) {
    Picture exr;
    exr.size_px = picture.size_px;
    exr.layers = {{"", {"R", "G", "B"}, {}}};
    for (const glm::vec3& rgb : picture.radiance)
        exr.layers[0].values.insert(exr.layers[0].values.end(), {rgb.r, rgb.g, rgb.b});
    write_picture(exr, std::nullopt, name);
    return {name, name};
}

SceneEnvironment constant_sky(glm::vec3 radiance) {
    return write_sky(sky(8, [&](glm::dvec3) { return radiance; }), "constant.exr");
}

SceneEnvironment sunny_sky() {
    return write_sky(sunny_sky(32), "sunny.exr");
}

SceneEnvironment soft_sky() {
    return write_sky(
        sky(32,
            [](glm::dvec3 d) {
                return glm::vec3(static_cast<float>(0.1 + std::exp(6.0 * (d.z + 0.3 * d.x - 1.0))));
            }),
        "soft.exr");
}

shared::Brdf metal(shared::uint kind, float exponent, glm::vec2 alpha) {
    shared::Brdf brdf{};
    brdf.kind = kind;
    brdf.specular = glm::vec3(1.0F);
    brdf.exponent = exponent;
    brdf.alpha = alpha;
    brdf.cosines = {-1.0F, -1.0F, 1.0F};
    return brdf;
}

Scene under(const SceneEnvironment& sky) {
    Scene scene = floor_scene();
    scene.luminaires.clear();
    scene.cameras = {camera_at({0, -1.9, 0.9}, {0, 0.8, -0.6}, {0, 0, 1}, 0.9)};
    scene.environment = sky;
    return scene;
}

Scene under(const SceneEnvironment& sky, const shared::Brdf& brdf) {
    Scene scene = under(sky);
    scene.materials[0].given_brdf = brdf;
    return scene;
}

render::Rendered reference(const Scene& scene, int samples, bool has_shadows) {
    render::RenderOptions options = small();
    options.environment.method = render::EnvironmentMethod::Reference;
    options.samples = samples;
    options.effects.shadows = has_shadows ? render::Switch::Auto : render::Switch::Off;
    return render::render_cpu(scene, options);
}

void for_each_surface(const Picture& picture, const std::function<void(std::size_t)>& check) {
    int count = 0;
    for (std::size_t k = 0; k < layer(picture, "depth").values.size(); ++k)
        if (layer(picture, "depth").values[k] > 0.0F) {
            check(k);
            ++count;
        }
    EXPECT_GT(count, 100);
}

Scene with_ball(Scene scene) {
    constexpr int kRows = 24, kColumns = 48;
    Mesh ball;
    ball.name = "ball";
    for (int row = 0; row <= kRows; ++row)
        for (int column = 0; column <= kColumns; ++column) {
            const double polar = std::acos(-1.0) * row / kRows;
            const double azimuth = 2.0 * std::acos(-1.0) * column / kColumns;
            const glm::vec3 normal(std::sin(polar) * std::cos(azimuth),
                                   std::sin(polar) * std::sin(azimuth), std::cos(polar));
            ball.normals.push_back(normal);
            ball.positions_m.push_back(0.6F * normal + glm::vec3(0.0F, 0.0F, 0.3F));
        }
    for (unsigned row = 0; row < kRows; ++row)
        for (unsigned column = 0; column < kColumns; ++column) {
            const unsigned at = row * (kColumns + 1) + column, below = at + kColumns + 1;
            if (row > 0)
                ball.triangles.emplace_back(at, below + 1, at + 1);
            if (row + 1 < kRows)
                ball.triangles.emplace_back(at, below, below + 1);
        }
    scene.instances.push_back({"ball", static_cast<int>(scene.meshes.size()), glm::dmat4(1.0)});
    scene.meshes.push_back(ball);
    return scene;
}

double relative_rms(const Picture& a, const Picture& b) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < layer(b, "depth").values.size(); ++k)
        if (layer(b, "depth").values[k] > 0.0F) {
            sum += std::pow(static_cast<double>(layer(a, "").values[3 * k + 1] /
                                                layer(b, "").values[3 * k + 1]) -
                                1.0,
                            2);
            ++count;
        }
    return std::sqrt(sum / std::max(count, 1));
}

double rms_of_mean(const Picture& a, const Picture& b) {
    double squares = 0.0, sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < layer(b, "depth").values.size(); ++k)
        if (layer(b, "depth").values[k] > 0.0F) {
            const auto truth = static_cast<double>(layer(b, "").values[3 * k + 1]);
            squares += std::pow(static_cast<double>(layer(a, "").values[3 * k + 1]) - truth, 2);
            sum += truth;
            count += 1.0;
        }
    return std::sqrt(squares * count) / sum;
}

}  // namespace nearfield::test

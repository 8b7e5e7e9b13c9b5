// SPDX-License-Identifier: Apache-2.0
#include "render/gpu/film.h"

#include "render/film.h"
#include "render/gpu/storage.h"
#include "tests/render/gpu/gl_fixture.h"

#include <algorithm>
#include <cmath>

namespace nearfield::render::gpu {
namespace {

constexpr glm::ivec2 kSizePx(13, 9);  // no multiple of a group's 8 x 8
constexpr std::size_t kPixels = std::size_t{13} * 9;

class FilmTest : public GlTest {
  protected:
    // One lamp's light: radiance (x, 2x, 4x) and variance v everywhere.
    void add_lamp(Film& film, std::size_t lamp, float x, float v, float weight) {
        begin_lamp(film);
        std::vector<float> light, irradiance;
        for (std::size_t k = 0; k < kPixels; ++k) {
            light.insert(light.end(), {x, 2.0F * x, 4.0F * x, v});
            irradiance.insert(irradiance.end(), {8.0F * x, 0.0F, 0.0F, 1.0F});
        }
        upload(film.lamp_light, kSizePx, 4, light.data());
        upload(film.lamp_irradiance, kSizePx, 4, irradiance.data());
        end_lamp(film, lamp, weight);
    }

    static Picture empty_picture(std::size_t lamps) {
        Lamps of_scene;
        of_scene.lamps.resize(lamps);
        return make_picture(of_scene, kSizePx, {});
    }
};

TEST_F(FilmTest, MeansOverPassesByWeightAndVariancesByItsSquare) {
    Film film = make_film(device(), kSizePx, 2, false);
    // Two passes, the second of three times the weight.
    add_lamp(film, 0, 1.0F, 0.04F, 1.0F);
    add_lamp(film, 1, 10.0F, 0.0F, 1.0F);
    end_pass(film, 1.0F);
    add_lamp(film, 0, 2.0F, 0.01F, 3.0F);
    add_lamp(film, 1, 10.0F, 0.0F, 3.0F);
    end_pass(film, 3.0F);
    Picture picture = empty_picture(2);
    read_film(film, 1.0F, picture);
    const float first = (1.0F + 3.0F * 2.0F) / 4.0F;
    const float sigma = std::sqrt(0.04F + 9.0F * 0.01F) / 4.0F;
    for (std::size_t k = 0; k < kPixels; ++k) {
        EXPECT_FLOAT_EQ(picture.layers[kFirstLamp].values[3 * k], first);
        EXPECT_FLOAT_EQ(picture.layers[kFirstLamp + 1].values[3 * k + 2], 40.0F);
        EXPECT_FLOAT_EQ(picture.layers[kRadiance].values[3 * k + 1], 2.0F * (first + 10.0F));
        EXPECT_FLOAT_EQ(picture.layers[kIrradiance].values[3 * k], 8.0F * (first + 10.0F));
        EXPECT_FLOAT_EQ(picture.layers[kSigma].values[k], sigma);
    }
}

TEST_F(FilmTest, ClearsToBlack) {
    Film film = make_film(device(), kSizePx, 1, false);
    add_lamp(film, 0, 1.0F, 1.0F, 1.0F);
    end_pass(film, 1.0F);
    clear(film);
    Picture picture = empty_picture(1);
    read_film(film, 1.0F, picture);
    for (const Layer& layer : picture.layers)
        EXPECT_EQ(std::count(layer.values.begin(), layer.values.end(), 0.0F),
                  static_cast<std::ptrdiff_t>(layer.values.size()));
}

// The displayed picture is the CPU's, one step of 255 apart at most: exp and pow differ in their
// last bits.
TEST_F(FilmTest, ToneMapsAsTheCpuDoes) {
    Film film = make_film(device(), kSizePx, 1, false);
    std::vector<float> light;
    for (std::size_t k = 0; k < kPixels; ++k) {
        const float x = std::exp2(0.25F * static_cast<float>(k) - 12.0F);
        light.insert(light.end(), {x, 0.3F * x, k % 3 == 0 ? 4.0F * x : 0.0F, 0.0F});
    }
    begin_lamp(film);
    upload(film.lamp_light, kSizePx, 4, light.data());
    end_lamp(film, 0, 2.0F);
    end_pass(film, 2.0F);
    Picture picture = empty_picture(1);
    read_film(film, 1.0F, picture);
    for (const ToneMap operation : {ToneMap::Filmic, ToneMap::Papers}) {
        const Display expected = display(picture, {operation, 3.0});
        const Texture srgb = tone_map(device(), film, operation, 3.0);
        const std::vector<float> got = read_back(srgb, kSizePx, 4);
        int brightest = 0;
        for (std::size_t k = 0; k < kPixels; ++k)
            for (std::size_t c = 0; c < 3; ++c) {
                const auto shown = static_cast<int>(std::lround(255.0F * got[4 * k + c]));
                EXPECT_NEAR(shown, expected.srgb[3 * k + c], 1)
                    << "pixel " << k << " channel " << c;
                brightest = std::max(brightest, shown);
            }
        EXPECT_GT(brightest, 200);
    }
}

}  // namespace
}  // namespace nearfield::render::gpu

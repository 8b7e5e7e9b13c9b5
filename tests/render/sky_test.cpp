// SPDX-License-Identifier: Apache-2.0
#include "formats/files/error.h"
#include "render/cpu/render.h"
#include "tests/environment/skies.h"
#include "tests/render/pictures.h"
#include "tests/render/scenes.h"
#include "tests/render/sky_scenes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>

namespace nearfield::render {
namespace {

using test::constant_sky, test::difference, test::layer, test::metal, test::reference,
    test::relative_rms, test::small, test::sunny_sky, test::under;

void for_each_surface(const Picture& picture, const std::function<void(std::size_t)>& check) {
    int count = 0;
    for (std::size_t k = 0; k < layer(picture, "depth").values.size(); ++k)
        if (layer(picture, "depth").values[k] > 0.0F) {
            check(k);
            ++count;
        }
    EXPECT_GT(count, 100);
}

// Proves absolute scale: under light of 1 from everywhere a surface of albedo 0.5 looks 0.5, its
// irradiance is pi, and what is past it is 1. Filtered and as a reference.
TEST(Sky, ConstantLightGivesTheAlbedo) {
    const Scene scene = under(constant_sky(glm::vec3(1.0F)));
    for (const bool is_reference : {false, true}) {
        const Rendered rendered =
            is_reference ? reference(scene, 1024) : render_cpu(scene, small());
        const Picture& picture = rendered.picture;
        for_each_surface(picture, [&](std::size_t k) {
            EXPECT_NEAR(layer(picture, "").values[3 * k], 0.5F, is_reference ? 0.02F : 1e-3F);
            EXPECT_NEAR(layer(picture, "irradiance").values[3 * k], 3.14159F,
                        is_reference ? 0.12F : 6e-3F);
        });
        EXPECT_EQ(layer(picture, "").values, layer(picture, "environment").values);
        const auto& depth = layer(picture, "depth").values;
        const auto past = std::find(depth.begin(), depth.end(), 0.0F) - depth.begin();
        ASSERT_LT(past, static_cast<std::ptrdiff_t>(depth.size()));
        EXPECT_EQ(layer(picture, "").values[3 * static_cast<std::size_t>(past)], 1.0F);
    }
}

// Proves that filtered samples carry each lobe's weight: under constant light what they give is the
// lobe's albedo, which the reference draws in another way (it evaluates lobe and density).
TEST(Sky, ConstantLightGivesEachLobesAlbedo) {
    for (const shared::Brdf& brdf :
         {metal(shared::kBrdfPhong, 20.0F, {}), metal(shared::kBrdfGgx, 0.0F, {0.3F, 0.3F}),
          metal(shared::kBrdfWard, 0.0F, {0.2F, 0.4F}), metal(shared::kBrdfLafortune, 8.0F, {}),
          metal(shared::kBrdfHalfwayDisk, 30.0F, {})}) {
        const Scene scene = under(constant_sky(glm::vec3(1.0F)), brdf);
        RenderOptions options = small();
        options.environment.samples = 256;
        EXPECT_LT(relative_rms(render_cpu(scene, options).picture, reference(scene, 4096).picture),
                  0.015)
            << brdf.kind;
    }
}

// Proves that filtered samples converge to the reference where light is soft, and that under a sun
// of one pixel they are nearer to it than the same samples unfiltered, which hit it or miss it.
TEST(Sky, FilteredSamplesAreNearTheReference) {
    const auto error = [](const Scene& scene, const Picture& truth, FilterLevel level,
                          int samples) {
        RenderOptions options = small();
        options.environment.samples = samples;
        options.environment.level = level;
        options.environment.suns = 0;
        return test::rms_of_mean(render_cpu(scene, options).picture, truth);
    };
    const Scene soft = under(test::soft_sky(), metal(shared::kBrdfPhong, 30.0F, {}));
    const Picture soft_truth = reference(soft, 1024, false).picture;
    const double few = error(soft, soft_truth, FilterLevel::Fis, 16);
    const double more = error(soft, soft_truth, FilterLevel::Fis, 256);
    const Scene sunny = under(sunny_sky(), metal(shared::kBrdfPhong, 30.0F, {}));
    const Picture sunny_truth = reference(sunny, 4096, false).picture;
    const double filtered = error(sunny, sunny_truth, FilterLevel::Fis, 64);
    const double plain = error(sunny, sunny_truth, FilterLevel::None, 64);
    std::cout << "soft " << few << " -> " << more << "; sunny, filtered " << filtered
              << ", unfiltered " << plain << "\n";
    EXPECT_LT(more, 0.02);
    EXPECT_LT(more, 0.7 * few);
    EXPECT_LT(filtered, 0.8 * plain);
}

// Proves that the reference's sigma is its error: z over pixels of two runs with other seeds is of
// unit width, and its mean of both halves is the filtered diffuse light within the harmonics'
// bound.
TEST(Sky, ReferenceKnowsItsNoise) {
    const Scene scene = under(sunny_sky(), metal(shared::kBrdfGgx, 0.0F, {0.4F, 0.4F}));
    RenderOptions options = small();
    options.environment.method = EnvironmentMethod::Reference;
    options.samples = 256;
    const Picture a = render_cpu(scene, options).picture;
    options.seed = 2;
    const Picture b = render_cpu(scene, options).picture;
    double squares = 0.0;
    int count = 0;
    for_each_surface(a, [&](std::size_t k) {
        const auto y = [&](const Picture& p) {
            const std::vector<float>& v = layer(p, "").values;
            return 0.2126 * static_cast<double>(v[3 * k]) +
                   0.7152 * static_cast<double>(v[3 * k + 1]) +
                   0.0722 * static_cast<double>(v[3 * k + 2]);
        };
        const double sigma = std::hypot(static_cast<double>(layer(a, "sigma").values[k]),
                                        static_cast<double>(layer(b, "sigma").values[k]));
        ASSERT_GT(sigma, 0.0);
        squares += std::pow((y(a) - y(b)) / sigma, 2);
        ++count;
    });
    // Student's t of 6 degrees of freedom: variance 1.5, and some 200 pixels.
    EXPECT_GT(squares / count, 0.7);
    EXPECT_LT(squares / count, 2.5);
}

// Proves that an occluder hides the sky from the reference, and shadows=off shows it again.
TEST(Sky, ReferenceTracesVisibility) {
    Scene scene = under(constant_sky(glm::vec3(1.0F)));
    test::add_blocker(scene, "roof", {0, 0, 2.0}, {40.0F, 40.0F});
    const Rendered dark = reference(scene, 64);
    for_each_surface(dark.picture, [&](std::size_t k) {
        EXPECT_LT(layer(dark.picture, "environment").values[3 * k], 0.06F);
    });
    EXPECT_GT(dark.report.shadow_rays, 0U);
    const Rendered open = reference(scene, 64, false);
    EXPECT_EQ(open.report.shadow_rays, 0U);
    for_each_surface(open.picture, [&](std::size_t k) {
        EXPECT_GT(layer(open.picture, "environment").values[3 * k], 0.45F);
    });
}

// Proves that rotation turns what arrives as it turns the scene, and that intensity is a factor.
TEST(Sky, TurnsAndScales) {
    shared::Brdf brdf = metal(shared::kBrdfPhong, 10.0F, {});
    brdf.specular = glm::vec3(0.5F);
    brdf.diffuse = {0.2F, 0.3F, 0.4F};
    const Scene scene = under(sunny_sky(), brdf);
    const Rendered plain = render_cpu(scene, small());

    Scene bright = scene;
    bright.environment->intensity = 4.0;
    const Rendered four = render_cpu(bright, small());
    for (std::size_t k = 0; k < layer(plain.picture, "").values.size(); ++k)
        EXPECT_EQ(layer(four.picture, "").values[k], 4.0F * layer(plain.picture, "").values[k]);

    const glm::dmat4 turn = test::pose({0.3, 0.1, 0.2}, glm::normalize(glm::dvec3(0.4, 0.5, 0.6)));
    Scene turned = test::transformed(scene, turn);
    turned.environment->world_from_environment = glm::dmat3(turn);
    const Rendered both = render_cpu(turned, small());
    // Tangents of a mesh without them are made from world normals: isotropic lobes do not care but
    // for where samples fall.
    EXPECT_LT(difference(layer(plain.picture, "irradiance"), layer(both.picture, "irradiance")),
              1e-4);
    Scene sky_alone = test::transformed(scene, turn);
    EXPECT_GT(difference(layer(plain.picture, "irradiance"),
                         layer(render_cpu(sky_alone, small()).picture, "irradiance")),
              0.05);
}

std::string passes_in(const Rendered& rendered) {
    std::string text;
    for (const PlannedPass& pass : rendered.report.plan.passes)
        text += pass.is_in ? std::string(pass.name) + ";" : "";
    return text;
}

// Proves that a scene without environment runs none of it, one of diffuse materials no filtered
// samples, one of metals no harmonics, and that off is off; each with its reason.
TEST(Sky, OnlyWhereCalledFor) {
    const Scene diffuse = under(sunny_sky());
    Scene none = diffuse;
    none.environment.reset();
    EXPECT_EQ(passes_in(render_cpu(none, small(4))), "camera rays;");
    EXPECT_EQ(passes_in(render_cpu(diffuse, small(4))), "camera rays;environment;sky irradiance;");
    const Scene glossy = under(sunny_sky(), metal(shared::kBrdfPhong, 10.0F, {}));
    EXPECT_EQ(passes_in(render_cpu(glossy, small(4))),
              "camera rays;samples;gloss;environment;sky samples;");
    EXPECT_EQ(passes_in(reference(diffuse, 8)), "camera rays;environment;sky samples;");
    Scene with_roof = diffuse;
    test::add_blocker(with_roof, "roof", {0, 0, 2.0}, {1.0F, 1.0F});
    EXPECT_EQ(passes_in(render_cpu(with_roof, small(4))),
              "camera rays;environment;sky irradiance;sky rays;");

    Scene dimmed = diffuse;
    dimmed.environment->intensity = 0.0;
    dimmed.environment->path = "absent.exr";  // not opened
    EXPECT_EQ(passes_in(render_cpu(dimmed, small(4))), "camera rays;");
    RenderOptions off = small(4);
    off.effects.environment = Switch::Off;
    EXPECT_EQ(layer(render_cpu(diffuse, off).picture, "").values,
              layer(render_cpu(none, small(4)).picture, "").values);
    RenderOptions on = small(4);
    on.effects.environment = Switch::On;
    EXPECT_EQ(passes_in(render_cpu(none, on)), "camera rays;");
    EXPECT_THROW(render_cpu(under({"absent.exr", "absent.exr"}), small(4)), Error);

    const auto reason = [](const Rendered& rendered, PassId id) {
        for (const PlannedPass& pass : rendered.report.plan.passes)
            if (pass.id == id)
                return pass.reason;
        return std::string("no such pass");
    };
    EXPECT_THAT(reason(render_cpu(diffuse, small(4)), PassId::EnvironmentSamples),
                testing::HasSubstr("no material has a lobe"));
    EXPECT_THAT(reason(render_cpu(none, small(4)), PassId::EnvironmentSamples),
                testing::HasSubstr("the scene has none"));
    EXPECT_THAT(reason(render_cpu(diffuse, small(4)), PassId::Environment),
                testing::HasSubstr("sunny.exr"));
}

// Proves that lamps' light is what it is without a sky, and the sky's what it is without lamps.
TEST(Sky, AddsToLamps) {
    Scene scene = test::uneven_scene();
    const Picture lamps = render_cpu(scene, small()).picture;
    scene.environment = sunny_sky();
    const Picture both = render_cpu(scene, small()).picture;
    scene.luminaires.clear();
    const Picture sky = render_cpu(scene, small()).picture;
    float largest = 0.0F;
    for (const float value : layer(both, "").values)
        largest = std::max(largest, value);
    for (std::size_t k = 0; k < layer(both, "").values.size(); ++k)
        EXPECT_NEAR(layer(both, "").values[k],
                    layer(lamps, "").values[k] + layer(sky, "").values[k], 1e-6F * largest);
}

// Proves that the picture holds the same light after several passes, towards an error.
TEST(Sky, IsTheSameAfterSeveralPasses) {
    Scene scene = test::uneven_scene();
    scene.environment = sunny_sky();
    RenderOptions options = small();
    const Picture one = render_cpu(scene, options).picture;
    options.error_rel = 1e-12;  // the lamp is faint beside this sky
    options.samples = 256;
    const Rendered many = render_cpu(scene, options);
    EXPECT_GT(many.report.passes, 1);
    EXPECT_LT(difference(layer(one, "environment"), layer(many.picture, "environment")), 1e-6);
}

// Proves that the extension survives a file, and that what is wrong in it is named.
TEST(SkyScene, SurvivesAFileAndRefusesNonsense) {
    Scene scene = under(sunny_sky());
    scene.environment->world_from_environment =
        glm::dmat3(test::pose({}, glm::normalize(glm::dvec3(0.3, 0.5, -0.2))));
    scene.environment->intensity = 250.0;
    write_scene(scene, "sky.gltf");
    const Scene read = read_scene("sky.gltf");
    ASSERT_TRUE(read.environment.has_value());
    EXPECT_EQ(read.environment->uri, "sunny.exr");
    EXPECT_EQ(read.environment->intensity, 250.0);
    for (int c = 0; c < 3; ++c)
        EXPECT_LT(glm::distance(read.environment->world_from_environment[c],
                                scene.environment->world_from_environment[c]),
                  1e-12);
    const auto complaint =
        [](const std::string& extension) {
            std::ofstream("bad.gltf")
                << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[],)"
                << R"("extensions":{"NEARFIELD_environment":)" << extension
                << R"(}}],"extensionsUsed":["NEARFIELD_environment"]})";
            try {
                read_scene("bad.gltf");
            } catch (const Error& error) {
                return std::string(error.what());
            }
            return std::string("none");
        };
    using testing::HasSubstr;
    EXPECT_EQ(complaint(R"({"uri":"a.hdr"})"), "none");
    EXPECT_THAT(complaint("{}"), HasSubstr(".uri"));
    EXPECT_THAT(complaint(R"({"uri":"../a.hdr","colour":1})"), HasSubstr("colour"));
    EXPECT_THAT(complaint("3"),
                HasSubstr(".NEARFIELD_environment: cannot read scene: expected an object, got 3"));
    EXPECT_THAT(complaint(R"({"uri":"/a.hdr"})"), HasSubstr("relative to the scene"));
    EXPECT_THAT(complaint(R"({"uri":"a.hdr","intensity":-1})"), HasSubstr(".intensity"));
    EXPECT_THAT(complaint(R"({"uri":"a.hdr","rotation":[0,0,1]})"), HasSubstr(".rotation"));
    EXPECT_THAT(complaint(R"({"uri":"a.hdr","rotation":[0,0,1,1]})"), HasSubstr("length 1.41"));
}

}  // namespace
}  // namespace nearfield::render

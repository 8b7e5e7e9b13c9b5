// SPDX-License-Identifier: Apache-2.0
#include "app/convert_options.h"

#include "app/options.h"
#include "formats/model/profile.h"

namespace nearfield::app {
namespace {

const std::vector<const char*> kRayOptions = {
    "--u-plane-mm", "--s-plane-mm",    "--basis",           "--no-color",
    "--seed",       "--keep-ray-flux", "--keep-radiometric"};
const std::vector<const char*> kPhotometryOptions = {"--opening-mm", "--half-angle-deg",
                                                     "--depth-sides", "--lamp-set"};

void add_photometry_options(CLI::App& sub, PhotometryOptions& c) {
    sub.add_option(
           "--opening-mm", c.opening_mm,
           "of a photometric file: the luminous opening along x and y; by default as stated")
        ->expected(2)
        ->type_name("X Y");
    add_number(sub, "--half-angle-deg", c.half_angle_deg, 1.0, 85.0, "DEG",
               "of a photometric file: with one slab, light beyond is left out; 70");
    add_number(
        sub, "--depth-sides", c.depth_sides, 1.0, 1e6, "N",
        "of a photometric file: S lies this many of the opening's longer sides before it; 10");
    add_number(sub, "--lamp-set", c.lamp_set, 0, 999, "N",
               "of EULUMDAT: the lamps that the table is scaled to; 0");
}

}  // namespace

void add_convert_options(CLI::App& sub, ConvertCommand& c) {
    constexpr double kFar_mm = 1e6;
    sub.add_option("input", c.input,
                   "ray file: TM-25, Zemax, LightTools, Speos (docs/ray_files.md); or photometric "
                   "file: LM-63, EULUMDAT, TM-33 (docs/photometry.md)")
        ->required()
        ->type_name("FILE");
    add_output(sub, c.output, "light field to write, NAME.lightfield.exr");
    const auto plane = [&](const char* name, std::optional<double>& z_mm, const char* help) {
        add_number(sub, name, z_mm, -kFar_mm, kFar_mm, "MM", help);
    };
    plane("--u-plane-mm", c.options.u_plane_mm,
          "basis plane of the slab towards +z, in the file's z; automatic by default");
    plane("--s-plane-mm", c.options.s_plane_mm,
          "image plane of the slab towards +z, in the file's z; automatic by default");
    add_size(sub, "--grid", c.options.grid,
             "basis functions of every slab; by default automatic; of photometric files the larger "
             "number counts, for the opening's longer side (4)");
    add_size(sub, "--texels", c.options.texels,
             "texels of every image; by default automatic; of photometric files likewise (256)");
    add_choice(sub, "--slabs", c.options.slabs,
               {{"1", std::optional(1)}, {"5", std::optional(5)}, {"6", std::optional(6)}},
               "directions: z > 0, all but mainly -z, all; by default the fewest that lose < 1 %");
    add_choice(sub, "--basis", c.options.basis, same_words(model::profile_names()),
               "shape of the basis functions");
    add_number(sub, "--flux-lm,--flux-w", c.flux, 1e-9, 1e12, "FLUX",
               "scale the light to this total");
    sub.add_flag_callback(
        "--no-color", [&c] { c.options.color = false; }, "one channel Y even if rays have color");
    sub.add_flag("--keep-ray-flux", c.read.keep_ray_flux,
                 "keep the rays' own sum of flux where the file's header states another");
    sub.add_flag("--keep-radiometric", c.read.keep_radiometric,
                 "keep watts where wavelengths would give lumens");
    sub.add_flag("--allow-drop", c.allow_drop, "write even if over 2 % of the flux is lost");
    add_seed(sub, c.options.seed, "of cross-validation");
    add_photometry_options(sub, c.photometry);
}

void refuse_options_of_others(const CLI::App& sub, ConvertInput input) {
    const bool is_rays = input == ConvertInput::Rays;
    for (const char* name : is_rays ? kPhotometryOptions : kRayOptions)
        if (sub.get_option(name)->count() > 0)
            throw CLI::ValidationError(name, fmt::format("is for {} files alone, got a {} file",
                                                         is_rays ? "photometric" : "ray",
                                                         is_rays ? "ray" : "photometric"));
}

}  // namespace nearfield::app

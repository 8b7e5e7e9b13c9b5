// SPDX-License-Identifier: Apache-2.0
#include "app/export_proxy.h"

#include "app/export_photometry.h"
#include "app/farfield_page.h"
#include "app/output.h"
#include "formats/farfield/lamp_view.h"
#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/model/luminaire.h"
#include "formats/photometry/intensity.h"
#include "formats/proxies/far_field_scene.h"
#include "formats/proxies/projector_scene.h"

#include <fmt/format.h>

#include <filesystem>

namespace nearfield::app {
namespace {

namespace fs = std::filesystem;

// The input as the output's folder sees it.
std::string uri_beside(const std::string& input, const std::string& output) {
    const fs::path folder = fs::absolute(output).lexically_normal().parent_path();
    return fs::absolute(input).lexically_normal().lexically_relative(folder).generic_string();
}

void export_far_field(const LightField& lightfield,
                      const std::string& input,
                      const std::string& output,
                      const ProxyExport& options) {
    const photometry::Photometry table = far_field_table(lightfield, input, {});
    const std::string ies = ies_beside(output);
    write_photometry(table, photometry::FileFormat::Lm63, ies);
    const proxies::FarFieldProxy proxy{uri_beside(input, output), fs::path(ies).filename().string(),
                                       farfield::light_center_m(lightfield),
                                       photometry::flux_lm(table)};
    write_file(options.format == ProxyFormat::Gltf ? gltf_proxy(proxy) : usd_proxy(proxy), output);
    say(fmt::format("{} and {}: {:.6g} lm from afar, near field in {}\n", output, ies,
                    proxy.flux_lm, proxy.luminaire_uri));
}

void export_projectors(const LightField& lightfield,
                       const std::string& input,
                       const std::string& output,
                       const ProxyExport& options) {
    const auto renderer = options.format == ProxyFormat::Mitsuba ? proxies::Renderer::Mitsuba3
                                                                 : proxies::Renderer::Pbrt4;
    const std::vector<proxies::Projector> projectors = proxies::projectors_of(lightfield);
    const fs::path folder = fs::path(output).replace_extension().string() + "_projectors";
    std::error_code failure;
    fs::create_directories(folder, failure);
    if (failure)
        throw Error{"cannot make folder", folder.string(), "", failure.message()};
    std::vector<std::string> names;
    for (std::size_t k = 0; k < projectors.size(); ++k) {
        const fs::path picture = folder / fmt::format("{:04}.exr", k);
        write_projector_picture(projectors[k], renderer, picture.string());
        names.push_back((folder.filename() / picture.filename()).generic_string());
    }
    write_file(projector_scene(projectors, names, renderer, fs::path(input).filename().string()),
               output);

    farfield::NearFarOptions near_far;
    near_far.size = 17;
    near_far.errors = {0.01, 0.02, 0.05};
    near_far.stand_in = [&projectors](const model::Receiver& receiver) {
        return proxies::irradiance(projectors, receiver);
    };
    const farfield::NearFarMap map = farfield::near_far_map(lightfield, near_far);
    print(farfield_text(map, "the array"));
    if (!options.report.empty())
        write_page(farfield_page(map, lightfield.quantity, fs::path(output).filename().string(),
                                 "the array of projectors"),
                   options.report);
    say(fmt::format("{}: {} projectors, pictures in {}\n", output, projectors.size(),
                    folder.string()));
}

}  // namespace

std::string ies_beside(const std::string& output) {
    return fs::path(output).replace_extension(".ies").string();
}

void export_proxy(const std::string& input, const std::string& output, const ProxyExport& options) {
    const double start_s = now_s();
    const LightField lightfield = read_lightfield(input);
    if (options.format == ProxyFormat::Gltf || options.format == ProxyFormat::Usd)
        export_far_field(lightfield, input, output, options);
    else
        export_projectors(lightfield, input, output, options);
    say(fmt::format("{}\n", cost(record_run(start_s))));
}

}  // namespace nearfield::app

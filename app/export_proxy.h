// SPDX-License-Identifier: Apache-2.0
/// `nearfield export` to scenes of other renderers: far-field proxies and projector arrays.
#pragma once

#include <string>

namespace nearfield::app {

enum class ProxyFormat { Gltf, Usd, Mitsuba, Pbrt };

struct ProxyExport {
    ProxyFormat format = ProxyFormat::Gltf;
    std::string report;  // page with the map of a projector array's errors; empty: none
};

/// The output with another ending: the IES file beside a far-field proxy.
std::string ies_beside(const std::string& output);

/// Writes the scene and what it names: NAME.ies beside a far-field proxy, NAME_projectors/ beside a
/// projector array, of which it says from which distance on it holds 2 %.
void export_proxy(const std::string& input, const std::string& output, const ProxyExport& options);

}  // namespace nearfield::app

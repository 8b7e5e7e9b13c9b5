// SPDX-License-Identifier: Apache-2.0
/// Scenes that give other renderers a lamp's far field and name its near-field file.
#pragma once

#include <glm/glm.hpp>

#include <string>

namespace nearfield::proxies {

struct FarFieldProxy {
    std::string luminaire_uri, ies_uri;  // as seen from the scene's folder
    glm::dvec3 center_m{0.0};            // of the light, in the luminaire's frame: the point source
    double flux_lm = 0;
};

/// glTF 2.0: a node with NEARFIELD_luminaire and, in it, one with EXT_lights_ies, whose light's
/// photometric zero points along its -z, C0 along +x.
std::string gltf_proxy(const FarFieldProxy& proxy);

/// USD (.usda): an Xform with the near-field file as a custom asset and, in it, a SphereLight that
/// is treated as a point, shaped by the IES file, whose axis is its -z.
std::string usd_proxy(const FarFieldProxy& proxy);

}  // namespace nearfield::proxies

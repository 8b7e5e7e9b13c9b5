// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace nearfield::gltf {

/// Reads an accessor of float triples. Throws Error naming `where` and the offending element if the
/// accessor, its view or its buffer is missing, of another type, too small, sparse, or holds a
/// number that is not finite.
std::vector<glm::vec3> read_vec3(const tinygltf::Model& model,
                                 int accessor,
                                 const std::string& where);

/// The same of four floats.
std::vector<glm::vec4> read_vec4(const tinygltf::Model& model,
                                 int accessor,
                                 const std::string& where);

/// Reads an accessor of unsigned integers, each below `limit`. Throws like read_vec3.
std::vector<std::uint32_t> read_indices(const tinygltf::Model& model,
                                        int accessor,
                                        std::size_t limit,
                                        const std::string& where);

}  // namespace nearfield::gltf

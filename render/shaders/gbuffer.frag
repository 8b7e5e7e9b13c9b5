// SPDX-License-Identifier: Apache-2.0
// Which triangle is seen; gbuffer.comp finds where.
layout(location = 0) out uint triangle;  // 1 + its number

void main() {
    triangle = uint(gl_PrimitiveID) + 1u;
}

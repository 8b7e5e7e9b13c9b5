// SPDX-License-Identifier: Apache-2.0
// Depth alone.
void main() {
}

// SPDX-License-Identifier: BSD-3-Clause
// Precompiled headers belong to a target with a source, which is this one.

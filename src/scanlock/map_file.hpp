// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component files: map files (.map) as scanlockd reads and writes them.
#pragma once

#include "io/map_file.hpp"
#include "scanlock/map.hpp"

// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component files: decodes LCM messages (their bytes) to scans, and encodes scans and poses to messages,
// without an LCM library. The message types themselves, scanlock/lcmtypes/PACKAGE/TYPE.hpp, need component
// lcm.
#pragma once

#include "messages/decode_scan.hpp"
#include "messages/encode.hpp"
#include "messages/encode_scan.hpp"
#include "messages/fingerprints.hpp"
#include "messages/sector_assembler.hpp"
#include "scanlock/odometry.hpp"

// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component files: the bytes of LCM messages to scans, poses to the bytes of messages, without a library of
// LCM. The message types themselves are in scanlock/lcmtypes/PACKAGE/TYPE.hpp, which want the component lcm.
#pragma once

#include "messages/decode_scan.hpp"
#include "messages/encode.hpp"
#include "messages/encode_scan.hpp"
#include "messages/fingerprints.hpp"
#include "messages/sector_assembler.hpp"
#include "scanlock/odometry.hpp"

// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace psfm {

struct ServeRequest {
    std::string session;
    std::string listen = "127.0.0.1:8080";
    std::vector<std::string> hosts;
    int threads = 0;
    std::string log;
    std::uint64_t quota_mib = 20480;
    std::uint64_t free_mib = 1024;
};

/// Serves a session and takes photographs into it until Ctrl-C.
/// @return the program's exit code; failures have been reported
int serve_session(const ServeRequest& request);

/// Serves a session that is stored, or that another process works on, for looking only.
/// @return as above
int view_session(const std::string& session, const std::string& listen);

struct DecodeRequest {
    std::string photo, name, preset = "default";
    bool thumbnail = false;
};
/// In a sandbox: what serve_session has decoded for itself.
int decode_photograph(const DecodeRequest& request);
/// The same of each that is asked for on the standard input (fork_decoders).
int decode_photographs();

}  // namespace psfm

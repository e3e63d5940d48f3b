// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace psfm {

/// The look of the report, its plots' classes among it. Greys l0 … l4 read in print, too.
inline constexpr const char* kReportStyle = R"(
body{font:15px/1.5 system-ui,sans-serif;color:#1b1f24;background:#fff;margin:0}
main{max-width:60rem;margin:0 auto;padding:1rem}
h1{font-size:1.5rem}h2{font-size:1.2rem;margin-top:2.2rem;border-bottom:1px solid #d4d9df}
h3{font-size:1rem;margin:1.2rem 0 .3rem}
.explains{color:#4a5560;max-width:46rem}
.weak{color:#7a1f0c;max-width:46rem}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;margin:.5rem 0}
th,td{text-align:left;padding:.15rem .7rem .15rem 0;border-bottom:1px solid #e7eaee;vertical-align:top;overflow-wrap:break-word}
th{font-weight:600}
svg{display:block;width:100%;max-width:640px;height:auto;margin:.5rem 0}
svg text{font:11px system-ui,sans-serif;fill:#3c4650}
.end{text-anchor:end}.middle{text-anchor:middle}
.grid{stroke:#e1e5ea}.scale{stroke:#1b1f24;stroke-width:2}
.bar{fill:#2f6f9f}.curve{fill:none;stroke-width:2}
.s0{stroke:#8894a0}.s1{stroke:#2f6f9f}.s2{stroke:#b5482a}
.l0{fill:#e3ebf2}.l1{fill:#bcd0e0}.l2{fill:#8fb1cb}.l3{fill:#5587ac}.l4{fill:#1d4f77}
.edge{fill:none;stroke-width:.6}
.edge.l0{stroke:#dbe5ed}.edge.l1{stroke:#bcd0e0}.edge.l2{stroke:#8fb1cb}.edge.l3{stroke:#5587ac}.edge.l4{stroke:#1d4f77}
.edge.against{stroke:#c2331e}
.camera{fill:#b5482a}.arrow{stroke:#7a1f0c;fill:#7a1f0c}.empty{fill:#fff;stroke:#eceff2}.frame{fill:none;stroke:#c6ccd3}
@media screen and (max-width:48rem){th,td{overflow-wrap:anywhere}}
@media print{main{max-width:none;padding:0}h2{break-after:avoid}svg,tr{break-inside:avoid}body{font-size:11px}}
)";

}  // namespace psfm

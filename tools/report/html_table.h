// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "tools/report/svg.h"

namespace psfm {

/// A table of texts, none of which is taken for markup.
class HtmlTable {
  public:
    /// @param names  of the columns; all empty: no line of names
    explicit HtmlTable(const std::vector<std::string>& names) : html_("<table>\n") {
        bool any = false;
        for (const std::string& name : names) any = any || !name.empty();
        if (!any) return;
        html_ += "<thead><tr>";
        for (const std::string& name : names) html_ += "<th>" + escaped(name) + "</th>";
        html_ += "</tr></thead>\n";
    }
    void row(const std::vector<std::string>& cells) {
        html_ += "<tr>";
        for (const std::string& cell : cells) html_ += "<td>" + escaped(cell) + "</td>";
        html_ += "</tr>\n";
    }
    std::string finish() const { return html_ + "</table>\n"; }

  private:
    std::string html_;
};

}  // namespace psfm

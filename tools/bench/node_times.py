# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""The last line of a log: what each node of the flow graph did with its time."""
from report import number, table


def bottleneck(event):
    """The node that worked for the largest part of the time."""
    return max(event["nodes"], key=lambda node: node["busy_s"], default={"node": "none"})["node"]


def node_table(event):
    """Percent of the whole time, as Markdown."""
    whole = event["seconds"] or 1.0
    rows = []
    for node in event["nodes"]:
        rows.append([node["node"], number(node["runs"]), *(number(100 * node[key] / whole)
                                                           for key in ("busy_s", "waiting_s", "starved_s")),
                     number(node["work_s"], 1), number(1000 * node["queued_s"] / max(node["runs"], 1))])
    head = ["node", "runs", "busy [%]", "waiting [%]", "starved [%]", "work [s]", "an input waited [ms]"]
    threads = f"{event['threads']} thread{'s' if event['threads'] > 1 else ''}"
    return (f"Nodes of the flow graph over {number(whole, 1)} s on {threads}; busiest: {bottleneck(event)}.\n\n"
            + table(head, rows))

"""Dashboards ask for metrics that exist: each name in a query of deploy/grafana/*.json stands in
server/base/metrics.h."""

import json
import re

import tree

NAME = re.compile(r"\b(?:beltflow|process)_[a-z_]+\b")
SUFFIX = re.compile(r"_(?:bucket|sum|count)$")


def queries(value):
    """Every Prometheus query in a dashboard."""
    if isinstance(value, list):
        for item in value:
            yield from queries(item)
    elif isinstance(value, dict):
        for key, item in value.items():
            if key in ("expr", "definition"):
                yield item
            else:
                yield from queries(item)


def dashboard_faults(root, path, known):
    name = tree.name(root, path)
    try:
        dashboard = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as fault:
        yield f"{name}: is not JSON: {fault}"
        return
    for query in queries(dashboard):
        for metric in NAME.findall(query):
            if metric not in known and SUFFIX.sub("", metric) not in known:
                yield f"{name}: asks for {metric}, which server/base/metrics.h does not have"


def check(root):
    header = root / "server/base/metrics.h"
    known = set(NAME.findall(header.read_text(encoding="utf-8"))) if header.is_file() else set()
    return [fault for path in tree.files(root, "deploy/grafana/*.json")
            for fault in dashboard_faults(root, path, known)]


if __name__ == "__main__":
    tree.main(check)

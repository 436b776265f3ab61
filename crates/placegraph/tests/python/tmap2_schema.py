"""What the published schema of topological maps asks for."""

TMAP_NODE = {
    "type": "object",
    "required": ["meta", "node"],
    "properties": {
        "meta": {
            "type": "object",
            "required": ["map", "node", "pointset"],
            "properties": {key: {"type": "string"} for key in ("map", "node", "pointset")},
        },
        "node": {
            "type": "object",
            "required": ["edges", "name"],
            "properties": {
                "name": {"type": "string"},
                "parent_frame": {"type": "string"},
                "properties": {"type": "object"},
                "edges": {
                    "type": "array",
                    "items": {
                        "type": "object",
                        "required": ["edge_id", "node"],
                        "properties": {"edge_id": {"type": "string"}, "node": {"type": "string"}},
                    },
                },
            },
        },
    },
}
TMAP = {
    "type": "object",
    "required": ["meta", "metric_map", "name", "nodes", "pointset"],
    "properties": {
        "meta": {
            "type": "object",
            "required": ["last_updated"],
            "properties": {
                "last_updated": {"type": "string", "pattern": r"^\d{2}-\d{2}-\d{4}_\d{2}-\d{2}-\d{2}$"}
            },
        },
        "metric_map": {"type": "string"},
        "name": {"type": "string"},
        "pointset": {"type": "string"},
        "nodes": {"type": "array", "items": TMAP_NODE},
    },
}

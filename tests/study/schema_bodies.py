# SPDX-License-Identifier: MIT
"""Hypothesis strategies from JSON Schema: bodies that fit, and bodies that almost fit."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

NASTY: list[Any] = [
    None, True, False, 0, -1, 2**53, 2**63, 10**400, 1e308, -0.0, 0.5, "", "\x00", "a" * 3000,
    "'; DROP TABLE participant; --", "../../etc/passwd", "\ud800", "𝕏", [], {}, [[]], {"a": {}},
]  # fmt: skip


def fitting(schema: dict[str, Any], document: dict[str, Any]) -> st.SearchStrategy[Any]:
    """Values that the schema allows."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        return st.deferred(lambda: fitting(document["components"]["schemas"][name], document))
    for key in ("anyOf", "oneOf"):
        if key in schema:
            return st.one_of([fitting(option, document) for option in schema[key]])
    if "const" in schema:
        return st.just(schema["const"])
    if "enum" in schema:
        return st.sampled_from(schema["enum"])
    kind = schema.get("type")
    if kind == "object":
        return fitting_object(schema, document)
    if kind == "array":
        items = fitting(schema.get("items", {}), document)
        return st.lists(items, min_size=schema.get("minItems", 0), max_size=3)
    return fitting_scalar(kind, schema)


def fitting_object(schema: dict[str, Any], document: dict[str, Any]) -> st.SearchStrategy[Any]:
    required = set(schema.get("required", ()))
    properties = schema.get("properties", {})
    parts = {name: fitting(part, document) for name, part in properties.items()}
    return st.fixed_dictionaries(
        {name: part for name, part in parts.items() if name in required},
        optional={name: part for name, part in parts.items() if name not in required},
    )


def fitting_scalar(kind: str | None, schema: dict[str, Any]) -> st.SearchStrategy[Any]:
    if kind == "string":
        if "pattern" in schema:
            return st.from_regex(schema["pattern"], fullmatch=True)
        return st.text(max_size=min(schema.get("maxLength", 20), 40))
    if kind == "integer":
        return st.integers(schema.get("minimum", -(2**53)), schema.get("maximum", 2**53))
    if kind == "number":
        low = schema.get("minimum", schema.get("exclusiveMinimum", -1e9))
        return st.floats(low, schema.get("maximum", 1e9), exclude_min="exclusiveMinimum" in schema)
    if kind == "boolean":
        return st.booleans()
    return st.none()


@st.composite
def almost(draw: st.DrawFn, body: st.SearchStrategy[Any]) -> Any:
    """A fitting body in which something was replaced, removed, added or doubled."""
    value = draw(body)
    for _ in range(draw(st.integers(1, 3))):
        value = spoil(draw, value)
    return value


def spoil(draw: st.DrawFn, value: Any) -> Any:
    if isinstance(value, dict) and value:
        name = draw(st.sampled_from(sorted(value)))
        act = draw(st.sampled_from(("deeper", "replace", "remove", "add")))
        if act == "remove":
            return {k: v for k, v in value.items() if k != name}
        if act == "add":
            return {**value, draw(st.sampled_from(("id", "__proto__", "x" * 200))): 1}
        inner = spoil(draw, value[name]) if act == "deeper" else draw(st.sampled_from(NASTY))
        return {**value, name: inner}
    if isinstance(value, list) and value:
        i = draw(st.integers(0, len(value) - 1))
        return [*value[:i], spoil(draw, value[i]), *value[i:]]
    return draw(st.sampled_from(NASTY))

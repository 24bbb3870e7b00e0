"""The tables as documentation: `python -m swarm.analysis.table_reference > docs/tables.md`."""

from __future__ import annotations

import polars as pl

from swarm.analysis.copying.paths import path_table
from swarm.logs.completeness import HEALTH_SCHEMA
from swarm.logs.episodes import journeys, visits
from swarm.logs.tables import TABLE_OF, empty_table, table_names
from swarm.logs.units import meaning_of, unit_of
from swarm.markdown import table

_HEAD = """# The tables of a run

`swarm analyze RUN` writes these into `RUN/analysis/tables/NAME.parquet`, one row a message unless said
otherwise. Times count from the run's start. The units stand in each
file's metadata too (`units`, a JSON object):

    polars.read_parquet_metadata("RUN/analysis/tables/moves.parquet")["units"]

Tables about visits are there if there were any; those about copies if paths were remembered."""

_WORDS = {
    "journeys": "One row a journey from start to goal.",
    "visits": "One row a visit of an observer.",
    "copied_paths": "One row a remembered path.",
    "health": "One row a key and start of its sender: what the log has of it, and what is missing.",
    "looks": "One row a frame of an observation.",
    "smoothed": "One row a smoothed position of an observation.",
    "segments": "One row a straight piece of an observation.",
}


def tables() -> dict[str, pl.DataFrame]:
    """Every table without rows, those that put messages together first."""
    messages = {name: empty_table(name) for name in sorted(table_names(TABLE_OF))}
    of_visits = (messages[name] for name in ("visit_phases", "observations", "copy_errors"))
    return {
        "journeys": journeys(messages["moves"]),
        "visits": visits(*of_visits),
        "copied_paths": path_table([]),
        "health": pl.DataFrame(schema=HEALTH_SCHEMA),
        **messages,
    }


def markdown_page() -> str:
    """The page docs/tables.md."""
    return "\n\n".join([_HEAD, *(_section(name, frame) for name, frame in tables().items())]) + "\n"


def _section(name: str, frame: pl.DataFrame) -> str:
    rows = [
        [f"`{column}`", _type_name(of_type), unit_of(column), meaning_of(name, column)]
        for column, of_type in frame.schema.items()
    ]
    text = "\n\n".join(filter(None, (f"## {name}", _WORDS.get(name))))
    return f"{text}\n\n{table(['column', 'type', 'unit', 'meaning'], rows)}"


def _type_name(of_type: pl.DataType) -> str:
    return str(of_type).replace("(", " of ").replace(")", "").lower()


if __name__ == "__main__":
    print(markdown_page(), end="")

"""Turn the tables into pages for the report."""

from adapter import job
from walklab.figures.pages import table_page
from walklab.storage import read_table, write_text

if __name__ == "__main__":
    with job(snakemake):
        for table, title, page in zip(snakemake.input.tables, snakemake.params.titles, snakemake.output.pages, strict=True):
            write_text(table_page(read_table(table), title), page)

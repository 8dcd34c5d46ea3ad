"""`fsi check`: what a case holds."""

import fsi.parallel as parallel
from fsi.cli.arguments import CaseFile, Overrides, load
from fsi.report.console import standard_output

EXAMPLE = "Example: fsi check cases/two_discs.toml --set 'bodies.0.position=[-1.5, 0.0]'"


def check(case_file: CaseFile, overrides: Overrides = None) -> None:
    """Read a case and say what it holds: bodies, gaps, what is free or held, walls. Nothing is computed."""
    from fsi.case.checks.expected import check_expected

    case = load(case_file, overrides)
    check_expected(case)
    if parallel.is_root():
        from fsi.report.solution import print_case

        print_case(standard_output(), case)

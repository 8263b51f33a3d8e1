"""The study of many synthetic populations: claims and scores over all of them."""

if REPLICATED:

    rule count_claims:
        input:
            paper=PAPER,
            claims=expand(rules.check_claims.output.claims, replicate=REPLICATES),
        output:
            claims=report(
                f"{RUN}/claims.csv", caption="../report/table.rst", category="Tables"
            ),
        log:
            first(stage("count_claims", "log.txt")),
        params:
            code=code("count_claims.py"),
        script:
            "../scripts/count_claims.py"

    rule pool_scores:
        input:
            scores=expand(rules.score_forecasts.output.scores, replicate=REPLICATES),
        output:
            scores=report(
                f"{RUN}/scores.csv", caption="../report/table.rst", category="Tables"
            ),
        log:
            first(stage("pool_scores", "log.txt")),
        params:
            code=code("pool_scores.py"),
        script:
            "../scripts/pool_scores.py"

    rule draw_replicates:
        input:
            claims=rules.count_claims.output.claims,
            scores=rules.pool_scores.output.scores,
        output:
            figure("replicated_claims", "Verdicts"),
            figure("replicated_scores", "Evaluation"),
        log:
            first(stage("draw_replicates", "log.txt")),
        params:
            code=code("draw_replicates.py"),
        script:
            "../scripts/draw_replicates.py"

/// What a study says, in sentences (api/results/verdict.h).
///
///     equal               several points may be best, which ones, and by what this one was chosen
///     alone               no other point may be best
///     demand_met          where the demand is met, and the least value of the first parameter at which it is
///     demand_not_met      nowhere, and where it is nearest
///     front               with two objectives: between which points one has to choose
///     one_run_each        parts arrive by chance and each point was solved once: nothing is known of what chance does
///     everything_through  where all that is offered gets through
///     edge                the best point lies at an end of a range beyond which there may be a better one, and which range to try
///     no_chance           nothing is left to chance, so each point was solved once
///     no_value            no trial has a value of the first objective
///     confirmed           of screen: what the microscopic model compared with what, and how much the models differ there
///     undecided           of screen: same, trials having run out, or still going on
///     replications        of a point that is repeated alone: the mean of its runs, with Student's interval
///     jams                same: how many of its runs jammed, with Wilson's interval
///     unconfirmed         of screen: the microscopic model has said nothing yet

#pragma once

#include "api/results/verdict.h"
#include "api/study/study_document.h"
#include "core/study/study_choice.h"

/// Add the verdicts about a study. BF_ENOMEM.
BF_MUST_CHECK bf_status study_verdict_find(study_document *document, const study *s,
                                           const study_choice *choice, const bool *is_in,
                                           verdicts *ret_verdicts, bf_error *err);

/// Private to api/study.

#pragma once

#include "api/study/study_document.h"

/// Of what is offered: what is missing at the end of a run is still on the belt.
#define STUDY_WHOLE_FEED 0.99

/// Stands for a whole number that was not given.
#define STUDY_NOT_GIVEN UINT64_MAX

/// Defaults of a document, as the init of its table.
void study__init(void *item, size_t place);

/// The word of a key figure, "residence_s.p95", into MEMBER_TEXT_SIZE bytes.
void study__figure_word(figure_id id, char *ret_word);

/// Note what is wrong with a document whose members were read; fill in what follows from others.
void study__check(json_in *in, study_document *document);

/// Note numbers that are out of the ranges of the tables.
void study__check_ranges(json_in *in, const study_document *document);

/// Read a parsed document and check it; see study_document_read(). Of the base's scenario the document shares the tree.
BF_MUST_CHECK bf_status study__read_tree(json_in *in, const struct json_t *root,
                                         study_document *ret_document, bf_error *err);

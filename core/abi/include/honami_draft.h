/* honami_draft.h - structure builders: a draft, not part of ABI 1.1.
 *
 * It moves to honami.h, with this id, when an issue has used it. Until then a layout that changes changes the number in
 * its id, so that an old plugin is refused rather than misread. Rules and words are those of honami.h.
 */
#ifndef HONAMI_DRAFT_H
#define HONAMI_DRAFT_H

#include "honami.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a structure builder may draw on. */
typedef struct honami_structure_input {
  uint32_t struct_size;
  uint32_t max_threads;
  uint64_t seed;
  const honami_table *tracks;      /* honami.tracks/1 */
  const honami_table *times;       /* honami.times/1 */
  const honami_table *dendrogram;  /* honami.dendrogram/1 over the tracks, or NULL */
} honami_structure_input;

/* Grows a skeleton from grouped tracks; every plugin of kind "structure" has it. */
#define HONAMI_STRUCTURE "honami.structure/1"
typedef struct honami_structure_v1 {
  uint32_t struct_size;
  uint32_t reserved;
  /* Commits honami.skeleton/1.  [control & idle] */
  honami_code (*run)(honami_instance *instance, const honami_call *call, const honami_structure_input *input);
} honami_structure_v1;

#ifdef __cplusplus
}
#endif
#endif

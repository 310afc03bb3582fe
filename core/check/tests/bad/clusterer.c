/* clusterer.c - groups tracks by where they are on average, with one fault, chosen by -DFAULT=NAME; NONE is none. Faults
 * of the tree come with more than 12 tracks. */
#include "honami.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum fault { NONE, MERGES_TWICE, BY_ORDER, BY_SIZE, WITHOUT_THE_LAST, DIES_OF_NONE, DIES_OF_LOST };

#define MANIFEST                                                                                                    \
  "{\"honami\":1,\"abi\":[1,0],"                                                                                    \
  "\"library\":{\"id\":\"org.honami.bad\",\"version\":\"1.0.0\",\"license\":\"MIT\"},"                              \
  "\"plugins\":[{\"id\":\"org.honami.bad\",\"kind\":\"clusterer\",\"name\":\"Bad\",\"doc\":\"Has a fault.\","       \
  "\"interfaces\":[\"honami.clusterer/1\"],\"caps\":{\"deterministic\":true,\"parallel_instances\":true}}]}"
HONAMI_MANIFEST(MANIFEST);

static void destroy(honami_instance *instance) { free(instance); }

static honami_code set_params(honami_instance *instance, const honami_call *call, const honami_value *values, uint32_t n) {
  (void)instance, (void)call, (void)values, (void)n;
  return HONAMI_OK;
}

static const honami_column *column(const honami_table *table, const char *name) {
  for (uint32_t i = 0; i < table->ncols; i++)
    if (strcmp(table->cols[i].name, name) == 0) return &table->cols[i];
  return NULL;
}

/* A cluster: where it is, how many tracks it has, its number; not live once it was merged. */
typedef struct cluster { double x, y; uint32_t size, number; int live; } cluster;

static void mean(const honami_table *tracks, uint64_t k, cluster *to) {
  const float *x = (const float *)column(tracks, "x")->data, *y = (const float *)column(tracks, "y")->data;
  const uint8_t *status = (const uint8_t *)column(tracks, "status")->data;
  uint64_t first = ((const uint64_t *)column(tracks, "offset")->data)[k];
  uint32_t len = ((const uint32_t *)column(tracks, "len")->data)[k], n = 0;
  for (uint32_t i = 0; i < len; i++)
    if (status[first + i] == HONAMI_TRACKED) to->x += x[first + i], to->y += y[first + i], n++;
  if (FAULT == DIES_OF_LOST && n == 0) *(volatile int *)NULL = 1;
  if (n > 0) to->x /= n, to->y /= n;
  to->size = 1, to->number = (uint32_t)k, to->live = 1;
}

static honami_code run(honami_instance *instance, const honami_call *call, const honami_clusterer_input *input) {
  uint64_t n = input->tracks->rows;
  honami_column out[4] = {{"a", HONAMI_U32, 1, NULL, 0}, {"b", HONAMI_U32, 1, NULL, 0},
                          {"height", HONAMI_F64, 1, NULL, 0}, {"size", HONAMI_U32, 1, NULL, 0}};
  (void)instance;
  if (n < 2 && FAULT == DIES_OF_NONE) *(volatile int *)NULL = 1;
  if (n < 2) return call->fail(call, HONAMI_E_DATA, "two tracks at least");
  if (call->progress(call, 0, "grouping")) return HONAMI_E_CANCELLED;
  cluster *all = (cluster *)calloc(n, sizeof(cluster));
  if (!all) return call->fail(call, HONAMI_E_MEMORY, "no memory for the clusters");
  honami_code code = call->reserve(call, HONAMI_DENDROGRAM, n - 1, 4, out);
  if (code < 0) { free(all); return call->fail(call, code, "the host gives no memory"); }
  for (uint64_t k = 0; k < n; k++) mean(input->tracks, k, &all[k]);
  double height = 0;
  for (uint64_t merge = 0; merge + 1 < n; merge++) {
    uint64_t a = 0, b = 0;
    double best = INFINITY;
    if (merge % 16 == 0 && call->progress(call, (double)merge / (double)n, "grouping")) {
      free(all);
      return HONAMI_E_CANCELLED;
    }
    for (uint64_t i = 0; i < n; i++)
      for (uint64_t j = i + 1; j < n && all[i].live; j++) {
        double d = hypot(all[i].x - all[j].x, all[i].y - all[j].y);
        if (FAULT == BY_ORDER && n > 12) d = 1 + (double)j;
        if (FAULT == BY_SIZE && n > 12) d = fabs(d - 70) < 30 ? 1e-3 * d : d;
        if (all[j].live && d < best) best = d, a = i, b = j;
      }
    height = fmax(height, best);
    ((uint32_t *)out[0].data)[merge] = all[a].number;
    ((uint32_t *)out[1].data)[merge] = FAULT == MERGES_TWICE && n > 12 && merge == 5 ? all[a].number : all[b].number;
    ((double *)out[2].data)[merge] = height;
    ((uint32_t *)out[3].data)[merge] = all[a].size + all[b].size;
    double total = all[a].size + all[b].size;
    all[a].x = (all[a].x * all[a].size + all[b].x * all[b].size) / total;
    all[a].y = (all[a].y * all[a].size + all[b].y * all[b].size) / total;
    all[a].size += all[b].size, all[a].number = (uint32_t)(n + merge), all[b].live = 0;
  }
  free(all);
  return call->commit(call, HONAMI_DENDROGRAM, FAULT == WITHOUT_THE_LAST && n > 12 ? n - 2 : n - 1);
}

static const honami_clusterer_v1 clusterer = {HONAMI_SIZE_TO(honami_clusterer_v1, run), 0, run};

static const void *get_interface(honami_instance *instance, const char *id) {
  (void)instance;
  return strcmp(id, HONAMI_CLUSTERER) == 0 ? &clusterer : NULL;
}

static honami_instance *create(const honami_host_info *host, const honami_call *call, const char *plugin_id) {
  honami_instance *self;
  (void)host;
  if (strcmp(plugin_id, "org.honami.bad") != 0) {
    call->fail(call, HONAMI_E_UNSUPPORTED, "no such plugin");
    return NULL;
  }
  self = (honami_instance *)calloc(1, sizeof(honami_instance));
  if (!self) return NULL;
  self->struct_size = HONAMI_SIZE_TO(honami_instance, get_interface);
  self->destroy = destroy;
  self->set_params = set_params;
  self->get_interface = get_interface;
  return self;
}

HONAMI_EXPORT const honami_library *honami_library_v1(const honami_host_info *host) {
  static const honami_library library = {HONAMI_SIZE_TO(honami_library, create), HONAMI_ABI_MINOR, honami_note.text,
                                         sizeof(MANIFEST) - 1, create};
  (void)host;
  return &library;
}

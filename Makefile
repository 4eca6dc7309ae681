# All that is made goes to build/<variant>/; what is the same for every variant to build/gen (generated code), build/web
# (the page) and build/demo (the demo plan).
#   make            the programs and the page               make run     install what is missing, build, demo plan, serve
#   make test       every kind of test (docs/testing.md)    make test-deep  the long ones: sanitizers, clang, fuzzing
#   make test-deploy  the sample configurations of deploy/, each proxy in front of a daemon
#   make check      the quick ones for work: lint, units of C and of the page, in about a minute
#   make install PREFIX=/usr/local DESTDIR=
#   make test-unit test-render test-faults test-api test-web test-install test-long  one suite
#   make bench  lint  fuzz  cover  clean  guide-pictures
#   make where WORDS="isodose level"  which file to change; without words the whole index, build/where.md
# Variables: CC=gcc|clang  SAN=address,undefined|thread  WERROR=1  V=1  FUZZ_SECONDS=60
#   run: PLANS="folder ..." further folders of plans, ARGS="--listen 127.0.0.1:9000 ..." further flags of beamroomd
#   EXTRA_<path_with_underscores>  further flags for one source file
SHELL := /bin/bash
.DELETE_ON_ERROR:
.SUFFIXES:
.SECONDARY:

CC := $(if $(filter default,$(origin CC)),gcc,$(CC))
CXX := $(if $(filter clang%,$(notdir $(CC))),clang++,g++)
SAN ?=
comma := ,
VARIANT := $(if $(SAN),$(notdir $(CC))-$(subst $(comma),-,$(SAN)),$(if $(filter gcc,$(notdir $(CC))),release,$(notdir $(CC))))
B := build/$(VARIANT)
GEN := build/gen
WEB := build/web
Q := $(if $(V),,@)

VERSION := 0.2.0
PREFIX ?= /usr/local
SYSCONFDIR ?= /etc
NODE ?= node
PYTHON ?= /usr/bin/python3
FUZZ_SECONDS ?= 60
JOBS := $(if $(filter -j%,$(MAKEFLAGS)),,-j$(shell nproc))

# Sanitizer builds are for finding faults, with names of functions and lines in their reports: -O1 -g1 compiles in half the time.
OPTIMIZE ?= $(if $(SAN),-O1 -g1,-O2 -g)
# What the tests themselves do takes little time: -O1 compiles it in half of it.
$(foreach suite,unit render faults,$(B)/obj/tests/$(suite)/%.o): private OPTIMIZE = -O1 -g1
# Programs of tests are many and short-lived: gold links them in half the time, and without lines for a debugger (but names of functions) in half of that;
# `make TEST_LDFLAGS= build/release/unit/test_x` links one with them.
TEST_LDFLAGS := $(if $(shell command -v ld.gold),-fuse-ld=gold) $(if $(SAN)$(COVER),,-Wl,--strip-debug)

WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wvla -Werror=implicit-function-declaration $(if $(WERROR),-Werror)
CPPFLAGS += -I. -I$(GEN) -D_DEFAULT_SOURCE -D_POSIX_C_SOURCE=200809L -DBEAMROOM_VERSION='"$(VERSION)"'
CFLAGS += -std=c17 $(OPTIMIZE) -fno-math-errno -fstack-protector-strong -fPIE $(WARNINGS) -MMD -MP -pthread
# C++ is the shim over DCMTK alone (core/formats/dicom/*.cc): same checks, none of C++'s exceptions leave it.
CXXFLAGS += $(filter-out -std=c17 $(WARNINGS),$(CFLAGS)) -std=c++17 -Wall -Wextra -Wpedantic -Wconversion $(if $(WERROR),-Werror)
LDFLAGS += -pie -Wl,-z,relro,-z,now -pthread
ifneq ($(SAN),)
CFLAGS += -fsanitize=$(SAN) -fno-omit-frame-pointer -fno-sanitize-recover=all
# what checks the classes of C++ objects is linked into C++ programs alone, and ours are C
CXXFLAGS += $(if $(findstring undefined,$(SAN)),-fno-sanitize=vptr)
LDFLAGS += -fsanitize=$(SAN)
else
CPPFLAGS += -D_FORTIFY_SOURCE=2
endif
ifneq ($(COVER),)
CFLAGS += --coverage
LDFLAGS += --coverage
endif

DCMTK_LIBS := -ldcmjpeg -lijg8 -lijg12 -lijg16 -ldcmjpls -ldcmtkcharls -ldcmimgle -ldcmdata -loflog -lofstd -lstdc++
CORE_LIBS := $(DCMTK_LIBS) -lopenjp2 -lturbojpeg -lspng -lvpx -lfreetype -ldeflate -lz -lcjson -ldl -lm
UNPACK_LIBS := -larchive
SERVER_LIBS := -lmicrohttpd -Wl,--as-needed -lwebsockets -lev -lssl -lcrypto -Wl,--no-as-needed -lsqlite3 -lsodium -lcjson -lm

c_files = $(if $(wildcard $(1)),$(sort $(shell find $(wildcard $(1)) -name '*.c')))

# ---- generated from proto/ ------------------------------------------------------------------------------------------
PROTO := $(wildcard proto/*.json proto/*.md proto/*.yaml proto/gen/*.mjs) core/report/report_codes.h $(wildcard core/render/gl/shaders/*)
GEN_STAMP := $(GEN)/.stamp
$(GEN_STAMP): $(PROTO)
	$(Q)mkdir -p $(GEN)
	$(Q)$(NODE) proto/gen/main.mjs $(GEN)
	$(Q)touch $@
$(GEN)/%.c $(GEN)/%.h: $(GEN_STAMP) ;
# a description of the tests' own, through the same generator
TRIAL_STAMP := $(GEN)/.trial_stamp
$(TRIAL_STAMP): $(wildcard tests/gen/*) $(PROTO)
	$(Q)$(NODE) tests/gen/main.mjs $(GEN)
	$(Q)touch $@
$(GEN)/trial.c $(GEN)/trial_gen.c: $(TRIAL_STAMP) ;

# ---- objects and programs ---------------------------------------------------------------------------------------------
# core: everything but the main()s; wire: JSON edge shared by daemon, renderer and command line; server: the daemon's own.
CORE_SRC := $(call c_files,core) $(sort $(wildcard core/formats/dicom/*.cc))
WIRE_SRC := $(call c_files,server/wire)
SERVER_SRC := $(call c_files,server/room server/meeting server/net server/front server/http server/ws server/tls server/fleet server/store server/auth server/paper)
DAEMON_SRC := $(call c_files,server/daemon)
RENDERER_SRC := $(call c_files,server/renderer)
UNPACK_SRC := $(filter-out %_run.c,$(sort $(wildcard server/renderer/unpack*.c)))
CLI_SRC := $(call c_files,server/cli)
PRINTER_SRC := $(call c_files,server/printer)
GEN_SRC := $(GEN)/wire_gen.c $(GEN)/packets_gen.c $(GEN)/problem_gen.c $(GEN)/rights_gen.c $(GEN)/openapi.c

# The inner loops of the software rasteriser are written to be vectorised. No value changes by that; what does is the exception
# flags of the processor, which nobody reads.
EXTRA_core_render_soft_kernels := -O3 -fno-trapping-math
EXTRA_core_render_soft_kernels_avx2 := -O3 -fno-trapping-math
EXTRA_core_render_soft_track_kernels := -O3 -fno-trapping-math
EXTRA_core_render_soft_track_kernels_avx2 := -O3 -fno-trapping-math
# Functions of vectors are static there, so their convention of calls does not matter.
EXTRA_core_render_soft_volume_kernels := -O3 -fno-trapping-math -Wno-psabi
EXTRA_core_render_soft_volume_kernels_avx2 := -O3 -fno-trapping-math
# So are those over the cells of a picture.
EXTRA_core_formats_dicom_dicom_unpack := -O3
# The loops along rows of a dose are too.
EXTRA_core_dose_dvh_kernels := -O3 -fno-trapping-math
EXTRA_core_dose_dvh_sampler := -O3 -fno-trapping-math
# And the smallest and largest of columns of voxels.
EXTRA_core_surface_isosurface_bricks := -O3 -fno-trapping-math
# And the histories of a simulation.
EXTRA_core_transport_walk := -O3
EXTRA_core_transport_diffusion := -O3
EXTRA_core_transport_smooth := -O3
# And the rows of a picture that is reduced.
EXTRA_core_base_image_reduce := -O3
# FreeType's headers; the font that is compiled in is core/annotate/font.c's.
EXTRA_core_annotate_font := -isystem /usr/include/freetype2
# Pango's and Cairo's headers, as those of the system.
PANGO_FLAGS := $(patsubst -I%,-isystem %,$(shell pkg-config --cflags pangocairo 2>/dev/null))
PANGO_LIBS := -lpangocairo-1.0 -lpango-1.0 -lgobject-2.0 -lglib-2.0 -lcairo
EXTRA_server_printer_draw := $(PANGO_FLAGS)
EXTRA_server_printer_draw_blocks := $(PANGO_FLAGS)
EXTRA_server_printer_sheet := $(PANGO_FLAGS)

obj = $(patsubst %.c,$(B)/obj/%.o,$(patsubst %.cc,$(B)/obj/%.o,$(1)))
# What names the version is compiled anew when it changes.
$(shell mkdir -p $(GEN) && { echo '$(VERSION)' | cmp -s - $(GEN)/.version || echo '$(VERSION)' >$(GEN)/.version; })
$(call obj,$(shell grep -rl --include='*.c' BEAMROOM_VERSION core server tests)): $(GEN)/.version
$(B)/obj/%.o: %.cc | $(GEN_STAMP)
	@mkdir -p $(@D)
	$(if $(Q),@echo "  CXX $<")
	$(Q)$(CXX) $(CPPFLAGS) $(CXXFLAGS) -c $< -o $@
$(B)/obj/%.o: %.c | $(GEN_STAMP)
	@mkdir -p $(@D)
	$(if $(Q),@echo "  CC $<")
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) $(EXTRA_$(subst /,_,$(basename $<))) -c $< -o $@

$(B)/libcore.a: $(call obj,$(CORE_SRC) $(GEN)/scene.c $(GEN)/sentences_gen.c $(GEN)/volume_presets.c $(GEN)/dose_presets.c $(GEN)/color_maps.c $(GEN)/gl_shaders.c)
$(B)/libwire.a: $(call obj,$(WIRE_SRC) $(GEN_SRC))
$(B)/libserver.a: $(call obj,$(SERVER_SRC))
$(B)/lib%.a:
	@mkdir -p $(@D)
	$(Q)rm -f $@ && ar rcsD $@ $^

$(B)/beamroomd: $(call obj,$(DAEMON_SRC)) $(B)/libserver.a $(B)/libwire.a $(B)/libcore.a
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(SERVER_LIBS)
$(B)/beamroom-render: $(call obj,$(RENDERER_SRC)) $(B)/libwire.a $(B)/libcore.a
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(CORE_LIBS) $(UNPACK_LIBS) -lsodium
$(B)/beamroom: $(call obj,$(CLI_SRC)) $(B)/libwire.a $(B)/libcore.a
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(CORE_LIBS)

$(B)/beamroom-paper: $(call obj,$(PRINTER_SRC) server/renderer/confine.c server/renderer/seccomp.c) $(B)/libwire.a $(B)/libcore.a
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(PANGO_LIBS) -lcjson -lm

PROGRAMS := $(if $(DAEMON_SRC),$(B)/beamroomd) $(if $(RENDERER_SRC),$(B)/beamroom-render) $(if $(CLI_SRC),$(B)/beamroom) $(if $(PRINTER_SRC),$(B)/beamroom-paper)
.DEFAULT_GOAL := all
.PHONY: all programs
all: programs web
programs: $(PROGRAMS)

# ---- the page: web/, the pinned libraries and the generated tables, side by side as the browser loads them -------------
LIB := $(WEB)/lib
node_modules/.stamp: package.json package-lock.json .npmrc
	$(if $(Q),@echo "  NPM ci")
	$(Q)npm ci --loglevel=error </dev/null >/dev/null && touch $@
$(WEB)/.stamp: $(shell find web -type f 2>/dev/null) $(GEN_STAMP) node_modules/.stamp deploy/web.sh deploy/page.mjs
	$(Q)NODE=$(NODE) deploy/web.sh $(WEB) $(GEN)
	$(Q)touch $@
.PHONY: web
web: $(WEB)/.stamp

# ---- the demo plan and a daemon to look at it ----------------------------------------------------------------------------
DEMO := build/demo/plans/phantom
$(DEMO)/plan.json: $(call c_files,core/phantom) $(wildcard core/formats/*_write.c core/formats/*/*_write.c server/cli/phantom.c) | $(B)/beamroom
	$(if $(Q),@echo "  DEMO $(DEMO)")
	$(Q)rm -rf $(DEMO) $(DEMO).part && mkdir -p $(dir $(DEMO))
	$(Q)$(B)/beamroom phantom $(DEMO).part >/dev/null && mv $(DEMO).part $(DEMO)
.PHONY: demo run
demo: $(if $(CLI_SRC),$(DEMO)/plan.json)
run:
	@deploy/packages build run
	@$(MAKE) --no-print-directory $(if $(V),,-s) $(JOBS) all demo
	@mkdir -p build/demo/data
	@exec $(B)/beamroomd --plans build/demo/plans $(foreach folder,$(PLANS),--plans $(folder)) --data build/demo/data \
	    --web $(WEB) $(ARGS)

# ---- test programs: one a file; unit and render with cmocka, bench prints JSON lines ---------------------------------------
# What is not named test_* or bench_* in these folders is shared help. In tests/unit a program stands in the folder of what it tests; all are built
# side by side, so no two have one name.
define c_programs
$(1)_SRC := $(foreach file,$(call c_files,tests/$(1)),$(if $(filter $(2)_%,$(notdir $(file))),$(file)))
$(1)_HELP := $$(filter-out $$($(1)_SRC),$(call c_files,tests/$(1)))
$(1)_BIN := $$(patsubst %.c,$(B)/$(1)/%,$$(notdir $$($(1)_SRC)))
$$(foreach file,$$($(1)_SRC),$$(eval $(B)/$(1)/$$(basename $$(notdir $$(file))): $$(call obj,$$(file))))
$$($(1)_BIN): $$(call obj,$$($(1)_HELP)) $(B)/libserver.a $(B)/libwire.a $(B)/libcore.a
	@mkdir -p $$(@D)
	$$(Q)$$(CC) $$(LDFLAGS) $$(TEST_LDFLAGS) -o $$@ $$(filter %.o,$$^) $$(filter %.a,$$^) $$(CORE_LIBS) $$(SERVER_LIBS) $(3)
.PHONY: $(1)-programs $(1)-objects
$(1)-programs: $$($(1)_BIN)
$(1)-objects: $$(call obj,$$(call c_files,tests/$(1)))
endef
$(eval $(call c_programs,unit,test,-lcmocka))
$(B)/unit/test_renderer: | $(B)/beamroom-render
$(B)/obj/tests/unit/server/wire/test_fields.o: | $(TRIAL_STAMP)
$(B)/unit/test_fields: $(call obj,$(GEN)/trial.c $(GEN)/trial_gen.c)
$(unit_BIN): $(call obj,server/renderer/confine.c server/renderer/seccomp.c)
$(eval $(call c_programs,render,test,-lcmocka))
# tests/same.sh records every picture of these (tests/render/recorded.c)
$(render_BIN): private LDFLAGS += -Wl,--wrap=render_snapshot,--wrap=render_end
$(B)/render/test_resample: $(call obj,$(addprefix tests/unit/,data_folder.c oracle.c))
$(eval $(call c_programs,bench,bench,))
$(eval $(call c_programs,faults,test,-lcmocka))
$(eval $(call c_programs,fuzz,fuzz,-fsanitize=fuzzer))
$(B)/fuzz/fuzz_plan_parts: $(call obj,$(addprefix tests/unit/,data_folder.c made_chd.c made_dicom.c made_dose.c))
$(B)/fuzz/fuzz_plan_parts: private CORE_LIBS += -lcmocka
$(B)/unit/test_unpack: | $(B)/beamroom-render
$(B)/unit/test_digest: $(call obj,server/renderer/digest.c)
$(B)/unit/test_loader: $(call obj,$(addprefix server/renderer/,digest.c inbox.c loader.c profile_line.c question.c) $(wildcard server/renderer/*answers.c))
$(B)/unit/test_unpack $(B)/fuzz/fuzz_unpack: $(call obj,$(UNPACK_SRC))
$(B)/unit/test_unpack $(B)/fuzz/fuzz_unpack: private CORE_LIBS += $(UNPACK_LIBS)

$(B)/fuzz/fuzz_paper: $(call obj,$(filter-out %/main.c,$(PRINTER_SRC)))
$(B)/fuzz/fuzz_paper: private CORE_LIBS += $(PANGO_LIBS)

# Programs whose calls of the system fail on demand (tests/faults/faults.h): what they define takes the place of libc's for all
# libraries too (-rdynamic), and mem_new is led through it.
FAULTS_HELP := $(call obj,$(addprefix tests/unit/,data_folder.c fake_renderer.c fleet_world.c made_chd.c made_dicom.c made_dose.c made_series.c oracle.c room_fake.c rt_files.c) $(UNPACK_SRC))
$(faults_BIN): $(FAULTS_HELP)
$(B)/faults/test_paper: $(call obj,server/printer/order.c)
$(faults_BIN): private LDFLAGS += -rdynamic -Wl,--wrap=mem_new,--wrap=mem_copy_text
$(faults_BIN): private CORE_LIBS += $(UNPACK_LIBS)
# an exception passes through operator new; the sanitizer must not check what stands before it
$(B)/obj/tests/faults/faults.o: private CFLAGS += -fexceptions -fno-sanitize=all -U_FORTIFY_SOURCE -fno-builtin $(if $(findstring address,$(SAN)),-DFAULTS_ADDRESS)

# ---- suites; each ends with "name: N passed, N failed, N skipped" -----------------------------------------------------------
export BEAMROOM_BIN := $(abspath $(B))
export BEAMROOM_WEB := $(abspath $(WEB))
export BEAMROOM_DEMO := $(abspath build/demo/plans)
LABEL = $(1)$(if $(filter release,$(VARIANT)),, ($(VARIANT)))
# The thread sanitizer of this compiler cannot map its shadow where addresses are randomised widely.
RUNNER := $(if $(findstring thread,$(SAN)),$(shell setarch -R true 2>/dev/null && echo setarch -R))
# Programs run side by side; without a sanitizer many wait for most of their time. The thread sanitizer is slow: its programs
# are those that start threads of their own, or the first of those that read plans by the same ones.
ONE_THREAD := annotate video describe beam_numbers beam_place describe_beam contour_grid dvh_oracle dose_sera_means dicom_numbers dicom_rtplan_opening dicom_rtplan_real dicom_rtdose_dvh \
    isoeffective profile sera sera_chd sera_extras sera_files sera_rst dicom_file dicom_pixels dicom_oracle dicom_hostile dicom_rtdose dicom_rtdose_real dicom_rtplan \
    dicom_rtstruct dicom_rtstruct_real nifti nifti_oracle nrrd unpack document fields message frame packet plan_document shape_query head ws_parser ws_conformance ws_conformance_utf8 convert convert_edges plan_data plan_real \
    address api_routes beam_angles beam_camera beam_pick beams_drawn bookmark boundary camera clip_planes confine confine_calls contour_fill draw_clip \
    draw_list draw_volume encode image_values label_places marks mask mask_reduce mesh mesh_export missing nifti_pair nurbs outline packed phantom pick \
    pick_beams pick_cut pick_tracks pick_volume plane plan_json plan_limits reach recognise recognise_names region report roles room room_bookmarks \
    room_control room_crowd room_failures room_following room_items room_members room_obliques room_pace room_pointers room_presenter room_scene \
    shading shape target track_csv track_looks contour_combine dose_words dvh_bounds fit identity origins parts_left_out plan_cases recognise_content \
    registrations room_acceptance room_stale
UNIT_RUN = $(if $(findstring thread,$(SAN)),$(filter-out $(ONE_THREAD:%=$(B)/unit/test_%),$(unit_BIN)),$(unit_BIN))
# and those that draw each kind of thing once
RENDER_THREADS := caps isodose_pictures pauses pictures shapes soft tracks translucent volume wash
RENDER_RUN = $(if $(findstring thread,$(SAN)),$(RENDER_THREADS:%=$(B)/render/test_%),$(render_BIN))
PARALLEL := $(shell nproc)
TWICE := $(shell echo $$((2 * $(PARALLEL))))
# UNITS=whole: without the bounds that keep the units of `make test` short; the sanitizers run the whole
.PHONY: test-unit test-render test-render-long test-faults test-api test-web test-long test-install test test-deep lint
test-unit: $(UNIT_RUN)
	$(Q)$(if $(SAN),UNITS=whole) RUNNER="$(RUNNER)" PARALLEL=$(if $(SAN),$(PARALLEL),$(TWICE)) tests/run_programs.sh "$(call LABEL,unit)" $(UNIT_RUN)
test-render: $(RENDER_RUN)
	$(Q)RUNNER="$(RUNNER)" PARALLEL=$(PARALLEL) tests/run_programs.sh "$(call LABEL,render)" $(RENDER_RUN)
# FAULTS=whole: every call of some hundred, then in short steps; else every one of the first few, then in long ones
test-faults: $(faults_BIN)
	$(Q)FAULTS=$(FAULTS) PARALLEL=$(PARALLEL) tests/run_programs.sh "$(call LABEL,faults)" $(faults_BIN)
# Programs that make check and make test leave out. test-deep has these units under the sanitizers, as they hammer at processes, sockets and folders or
# wait for many seconds; and these pictures, of every back end against the others or drawn in turns, from the same build as make test.
DEEP_UNIT := $(patsubst %,$(B)/unit/test_%,cache_quota fleet_hostile fleet_restarts fleet_silence tls_hammer)
DEEP_RENDER := $(patsubst %,$(B)/render/test_%,caps cut_agreement occlusion pauses representations wash_agree)
test-render-long: $(DEEP_RENDER)
	$(Q)PARALLEL=$(PARALLEL) tests/run_programs.sh "$(call LABEL,render-long)" $(DEEP_RENDER)
# Long ones, from a queue of their own: LONG_NODE has files of which test-api and test-web run a part (LONG_TESTS=rest: what they leave out), DEEP_NODE those that they leave
# out whole. Each part of the page and of the interface has tests in what they run: whole_meeting.test.mjs has one of each thing that people do together.
LONG_TESTS ?= 1
DEEP_NODE := tests/api/hung.test.mjs tests/api/missing.test.mjs tests/api/slow.test.mjs tests/api/slow_disk.test.mjs $(patsubst %,tests/web/%.test.mjs,daemon_restart guide meeting notes planner_hour pointers record recording restart roster saved)
LONG_NODE := tests/api/kills.test.mjs tests/api/replayed_meeting.test.mjs tests/api/rest.test.mjs $(patsubst %,tests/web/%.test.mjs,axe beam_draft beam_eye bookmarks cases charts clip display dose greys image language layout legend measure page pointed \
    regions shell snapshot start touch tracks upload views watch)
# What a daemon does under load, and how it shares the cores, is seen without other tests beside it; the rest of the api tests wait for most of their time.
ALONE_NODE := tests/api/burst.test.mjs tests/api/fair.test.mjs
# All of them from one queue: what is left of one suite runs beside the next. On a page three things wait for each other, so few of these run at once.
API_NODE := $(filter-out $(DEEP_NODE) $(ALONE_NODE),$(sort $(wildcard tests/api/*.test.mjs tests/api/*/*.test.mjs)))
PAGE_UNITS := $(sort $(shell find tests/web/unit -name '*.test.mjs'))
.PHONY: test-queue check
test-queue: all demo $(unit_BIN) $(render_BIN) $(faults_BIN)
	$(Q)tests/run_node.sh api-alone $(ALONE_NODE); alone=$$?; \
	SLOTS=$(TWICE) $(NODE) tests/queue.mjs web:$$(($(PARALLEL) + 1)) $(filter-out $(DEEP_NODE),$(sort $(wildcard tests/web/*.test.mjs))) -- api $(API_NODE) \
	    -- faults:$(PARALLEL) $(faults_BIN) -- lint:1 tests/lint.sh -- install:1 tests/install.sh -- render:$(PARALLEL) $(filter-out $(DEEP_RENDER),$(render_BIN)) \
	    -- unit $(filter-out $(DEEP_UNIT),$(unit_BIN)) -- page-units $(PAGE_UNITS) && [ $$alone = 0 ]
# What takes longest of the units is for make test.
SLOW_UNITS := api_routes gamma gamma_oracle plan_jobs recording replay room_following room_recording smooth smooth_slices surface_oracle unpack
CHECK_UNITS = $(filter-out $(SLOW_UNITS:%=$(B)/unit/test_%) $(DEEP_UNIT),$(unit_BIN))
check: all $(CHECK_UNITS)
	$(Q)SLOTS=$(TWICE) $(NODE) tests/queue.mjs lint:1 tests/lint.sh -- unit $(CHECK_UNITS) -- page-units $(PAGE_UNITS)
test-api: all demo
	$(Q)tests/run_node.sh api-alone $(ALONE_NODE); alone=$$?; \
	TEST_CONCURRENCY=$(TWICE) tests/run_node.sh api $(API_NODE) && [ $$alone = 0 ]
# A page waits for its daemon about half of the time.
test-web: all demo
	$(Q)TEST_CONCURRENCY=$$(($(PARALLEL) + 1)) tests/run_node.sh web $(filter-out $(DEEP_NODE),$(sort $(wildcard tests/web/*.test.mjs)) $(PAGE_UNITS))
test-long: all demo
	$(Q)set -o pipefail; LONG_TESTS=$(LONG_TESTS) LAST_RUN=long SUITE_SECONDS=2400 SLOTS=$$(($(PARALLEL) + 1)) $(NODE) tests/queue.mjs \
	    long-web $(filter tests/web/%,$(DEEP_NODE) $(LONG_NODE)) -- long-api $(filter tests/api/%,$(DEEP_NODE) $(LONG_NODE)) \
	    | grep --line-buffered -vE '^[^: ]+: [0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$$'
test-install: all demo
	$(Q)tests/install.sh
lint: $(GEN_STAMP) node_modules/.stamp $(call obj,$(CORE_SRC) $(WIRE_SRC) $(SERVER_SRC) $(DAEMON_SRC) $(RENDERER_SRC) $(CLI_SRC))
	$(Q)tests/lint.sh
test:
	@deploy/packages build run test
	@tests/all.sh test
test-deep:
	@deploy/packages build run test firefox
	@tests/all.sh deep
test-deploy:
	@deploy/packages build run test deploy
	@tests/all.sh deploy
# What test-deploy runs: a file for each proxy, a few side by side.
.PHONY: test-deploy test-proxies
build/deploy/.stamp: tests/deploy/package.json tests/deploy/package-lock.json .npmrc
	$(if $(Q),@echo "  NPM ci build/deploy")
	$(Q)mkdir -p $(@D) && cp $^ $(@D) && (cd $(@D) && npm ci --loglevel=error </dev/null >/dev/null) && touch $@
test-proxies: all demo build/deploy/.stamp
	$(Q)TEST_CONCURRENCY=$(PARALLEL) tests/run_node.sh deploy $(sort $(wildcard tests/deploy/*.test.mjs))

# What test-deep runs of the page in Debian's Firefox.
.PHONY: test-firefox
build/firefox/.stamp: tests/firefox/package.json tests/firefox/package-lock.json .npmrc
	$(if $(Q),@echo "  NPM ci build/firefox")
	$(Q)mkdir -p $(@D) && cp $^ $(@D) && (cd $(@D) && npm ci --loglevel=error </dev/null >/dev/null) && touch $@
test-firefox: all demo build/firefox/.stamp
	$(Q)tests/run_node.sh firefox $(sort $(wildcard tests/firefox/*.test.mjs))

# ---- documents: to change X, look in Y; the pictures of the user's guide ----------------------------------------------------------
.PHONY: where guide-pictures
where:
	@mkdir -p build
	@$(NODE) docs/where.mjs $(if $(WORDS),- $(WORDS),build/where.md && echo build/where.md)
guide-pictures: all demo
	$(Q)$(NODE) docs/guide/pictures.mjs $(TOURS)

# ---- fuzzing: a variant of its own, every source instrumented ------------------------------------------------------------------
.PHONY: fuzz
fuzz:
	@deploy/packages build test
	@$(MAKE) --no-print-directory $(JOBS) CC=clang SAN=fuzzer-no-link,address,undefined VARIANT=fuzz fuzz-programs
	@FUZZ_SECONDS=$(FUZZ_SECONDS) tests/fuzz/run.sh build/fuzz/fuzz

# ---- figures, coverage -----------------------------------------------------------------------------------------------------------
.PHONY: bench cover
bench:
	@deploy/packages build run bench
	@$(MAKE) --no-print-directory $(if $(V),,-s) $(JOBS) all demo bench-programs
	@PYTHON=$(PYTHON) $(NODE) tests/bench/run.mjs build/bench.json
cover:
	@deploy/packages build run test
	@$(MAKE) --no-print-directory $(JOBS) VARIANT=cover COVER=1 unit-programs render-programs
	@find build/cover -name '*.gcda' -delete
	@$(MAKE) --no-print-directory VARIANT=cover COVER=1 test-unit test-render
	@tests/cover.sh build/cover

# ---- install -----------------------------------------------------------------------------------------------------------------------
# beamroomd looks for beamroom-render beside itself.
.PHONY: install
install: all
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/share/beamroom $(DESTDIR)$(SYSCONFDIR)/beamroom
	install -m 755 $(PROGRAMS) $(DESTDIR)$(PREFIX)/bin
	rm -rf $(DESTDIR)$(PREFIX)/share/beamroom/web
	cp -r $(WEB) $(DESTDIR)$(PREFIX)/share/beamroom/web && rm $(DESTDIR)$(PREFIX)/share/beamroom/web/.stamp
	for page in $(wildcard deploy/man/*.[1-8]); do \
	    install -D -m 644 $$page $(DESTDIR)$(PREFIX)/share/man/man$${page##*.}/$${page##*/} || exit 1; done
	for page in deploy/beamroomd.conf deploy/beamroomd.service; do \
	    sed 's|@PREFIX@|$(PREFIX)|g; s|@SYSCONFDIR@|$(SYSCONFDIR)|g' $$page >$(B)/$${page##*/} || exit 1; done
	install -D -m 644 $(B)/beamroomd.service $(DESTDIR)$(PREFIX)/lib/systemd/system/beamroomd.service
	[ -e $(DESTDIR)$(SYSCONFDIR)/beamroom/beamroomd.conf ] || \
	    install -m 644 $(B)/beamroomd.conf $(DESTDIR)$(SYSCONFDIR)/beamroom/beamroomd.conf
	for text in LICENSE THIRD-PARTY.md CHANGELOG.md; do install -D -m 644 $$text $(DESTDIR)$(PREFIX)/share/doc/beamroom/$$text || exit 1; done
	for sample in nginx.conf nginx-signin.conf Caddyfile Caddyfile.forward-auth haproxy.cfg apache-oidc.conf; do \
	    install -D -m 644 deploy/$$sample $(DESTDIR)$(PREFIX)/share/doc/beamroom/$$sample || exit 1; done
	install -D -m 644 /usr/share/doc/fonts-dejavu-core/copyright $(DESTDIR)$(PREFIX)/share/doc/beamroom/dejavu-font.copyright

.PHONY: clean
clean:
	rm -rf build

-include $(shell find $(B)/obj -name '*.d' 2>/dev/null)

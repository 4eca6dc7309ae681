# All that is made goes to build/<variant>/; generated code and the page's files, the same for all variants, to build/gen and build/web.
#   make            the three programs, man pages, web files        make run     install what is missing, build, demo plan, serve
#   make test       everything (see tests/README.md)                make install PREFIX=/usr/local DESTDIR=
#   make bench  lint  fuzz  cover  clean
# Variables: CC=gcc|clang  SAN=address,undefined|thread  V=1
SHELL := /bin/bash
.DELETE_ON_ERROR:
.SUFFIXES:
.SECONDARY:

CC := $(if $(filter default,$(origin CC)),gcc,$(CC))
SAN ?=
comma := ,
VARIANT := $(if $(SAN),$(notdir $(CC))-$(subst $(comma),-,$(SAN)),$(if $(filter gcc,$(notdir $(CC))),release,$(notdir $(CC))))
B := build/$(VARIANT)
GEN := build/gen
Q := $(if $(V),,@)

VERSION := 0.1.0
PREFIX ?= /usr/local
NODE ?= node
PYTHON ?= /usr/bin/python3
PARTS := $(shell nproc)

WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wvla -Werror=implicit-function-declaration $(if $(WERROR),-Werror)
CPPFLAGS += -I. -I$(GEN) -D_DEFAULT_SOURCE -D_POSIX_C_SOURCE=200809L -DBEAMROOM_VERSION='"$(VERSION)"'
CFLAGS += -std=c17 -O2 -g -fno-math-errno -fstack-protector-strong -fPIE $(WARNINGS) -MMD -MP -pthread
LDFLAGS += -pie -Wl,-z,relro,-z,now -pthread
ifneq ($(SAN),)
CFLAGS += -fsanitize=$(SAN) -fno-omit-frame-pointer -fno-sanitize-recover=all
LDFLAGS += -fsanitize=$(SAN)
else
CPPFLAGS += -D_FORTIFY_SOURCE=2
endif

CORE_LIBS := -lturbojpeg -lspng -lniftiio -lznz -ldeflate -lz -lcjson -ldl -lm
SERVER_LIBS := -lmicrohttpd -lwebsockets -lcjson -lm

# ---- generated from proto/ ------------------------------------------------------------------------------------------
PROTO := $(wildcard proto/*.json proto/*.md proto/*.yaml proto/gen/*.mjs)
GEN_STAMP := $(GEN)/.stamp
$(GEN_STAMP): $(PROTO)
	$(Q)mkdir -p $(GEN)
	$(Q)$(NODE) proto/gen/main.mjs $(GEN)
	$(Q)touch $@

# ---- objects --------------------------------------------------------------------------------------------------------
# core: everything but the main()s; wire: JSON edge shared by daemon, renderer and command line; server: the daemon's own.
CORE_SRC := $(shell find core -name '*.c' | sort)
WIRE_SRC := $(shell find server/wire -name '*.c' | sort)
SERVER_SRC := $(shell find server/room server/http server/ws server/fleet server/store server/auth -name '*.c' | sort)
DAEMON_SRC := $(shell find server/daemon -name '*.c' | sort)
RENDERER_SRC := $(shell find server/renderer -name '*.c' | sort)
CLI_SRC := $(shell find server/cli -name '*.c' | sort)
GEN_SRC := $(GEN)/wire_gen.c

obj = $(patsubst %.c,$(B)/obj/%.o,$(1))
$(B)/obj/%.o: %.c | $(GEN_STAMP)
	@mkdir -p $(@D)
	$(if $(Q),@echo "  CC $<")
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) $(EXTRA_$(subst /,_,$(basename $<))) -c $< -o $@
$(GEN)/%.c: $(GEN_STAMP) ;

$(B)/libcore.a: $(call obj,$(CORE_SRC))
$(B)/libwire.a: $(call obj,$(WIRE_SRC) $(GEN_SRC))
$(B)/libserver.a: $(call obj,$(SERVER_SRC))
$(B)/lib%.a:
	@mkdir -p $(@D)
	$(Q)rm -f $@ && ar rcsD $@ $^

$(B)/beamroomd: $(call obj,$(DAEMON_SRC)) $(B)/libserver.a $(B)/libwire.a $(B)/libcore.a
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(SERVER_LIBS)
$(B)/beamroom-render: $(call obj,$(RENDERER_SRC)) $(B)/libwire.a $(B)/libcore.a
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(CORE_LIBS)
$(B)/beamroom: $(call obj,$(CLI_SRC)) $(B)/libwire.a $(B)/libcore.a
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(CORE_LIBS)

PROGRAMS := $(if $(DAEMON_SRC),$(B)/beamroomd) $(if $(RENDERER_SRC),$(B)/beamroom-render) $(if $(CLI_SRC),$(B)/beamroom)
.DEFAULT_GOAL := all
.PHONY: all programs
all: programs web
programs: $(PROGRAMS)

# ---- unit tests (cmocka): one program a file in tests/unit -----------------------------------------------------------
UNIT_SRC := $(shell find tests/unit -name 'test_*.c' | sort)
UNIT_HELP := $(shell find tests/unit -name '*.c' ! -name 'test_*.c' | sort)
UNIT_BIN := $(patsubst tests/unit/%.c,$(B)/unit/%,$(UNIT_SRC))
$(B)/unit/%: $(B)/obj/tests/unit/%.o $(call obj,$(UNIT_HELP)) $(B)/libserver.a $(B)/libwire.a $(B)/libcore.a
	@mkdir -p $(@D)
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(CORE_LIBS) $(SERVER_LIBS) -lcmocka
.PHONY: unit-programs test-unit
unit-programs: $(UNIT_BIN)
test-unit: $(UNIT_BIN)
	$(Q)tests/run_programs.sh unit $(UNIT_BIN)

# ---- the page --------------------------------------------------------------------------------------------------------
.PHONY: web
web: $(GEN_STAMP)

.PHONY: clean
clean:
	rm -rf build

-include $(shell find $(B)/obj -name '*.d' 2>/dev/null)

import { groupsOf } from "../app/groups";
import type { Page } from "../app/page";
import {
  applicable,
  changesToDefaults,
  choiceOf,
  admissible,
  groupNames,
  hasPreset,
  methodOf,
  methods,
  numberOf,
  preset,
  settingOf,
  switchOf,
  usualOf,
  type Setting,
  type SettingChanges,
  type Settings,
} from "../app/method_settings";
import { Button } from "./ui/button";
import { Segments, Select, Slider, Toggle } from "./ui/fields";
import { More, Section } from "./ui/section";

/** The deformation method and its settings. */
export function MethodPanel({ page }: { page: Page }) {
  const { editor } = page;
  const settings = settingsOf(page);
  const chosen = methods.find(({ value }) => value === methodOf(settings));
  const change = (changes: SettingChanges) =>
    void editor.ask({ do: "settings", settings: changes });
  const all = applicable(settings);
  const usual = changesToDefaults(settings);
  return (
    <Section
      title="Method"
      hint="How the surface follows the handles. Switch to compare."
      badge={hasPreset(settings) ? preset.label : chosen?.label}
      startsOpen
    >
      <Segments
        label="Method"
        hideLabel
        inPairs
        value={methodOf(settings)}
        choices={methods}
        onChange={(method) => change({ method })}
      />
      <p class="explained">{chosen?.help}</p>
      <SettingsOf
        settings={all.filter(({ group, more }) => group === "shape" && more !== true)}
        values={settings}
        change={change}
      />
      <More label="More settings">
        <Toggle
          label={preset.label}
          help={preset.help}
          value={hasPreset(settings)}
          onChange={(on) => change({ preset: on ? preset.value : null })}
        />
        <MoreSettings all={all} values={settings} change={change} />
        <Anchors page={page} />
        <Button
          label="Restore defaults"
          icon="reset"
          kind="quiet"
          disabled={Object.keys(usual).length === 0}
          tip="Resets these settings and switches the preset off. The method stays."
          onClick={() => change(usual)}
        />
      </More>
    </Section>
  );
}

export function settingsOf(page: Page): Settings {
  return (page.editor.state.value?.settings ?? {}) as Settings;
}

interface SettingsProps {
  values: Settings;
  change: (changes: SettingChanges) => void;
}

function MoreSettings({ all, values, change }: SettingsProps & { all: readonly Setting[] }) {
  const rest = all.filter(({ group, more }) => group !== "shape" || more === true);
  const groups = [...new Set(rest.map(({ group }) => group))];
  return (
    <>
      {groups.map((group) => (
        <fieldset key={group}>
          <legend>{groupNames[group]}</legend>
          <SettingsOf
            settings={rest.filter((setting) => setting.group === group)}
            values={values}
            change={change}
          />
        </fieldset>
      ))}
    </>
  );
}

function SettingsOf({ settings, values, change }: SettingsProps & { settings: readonly Setting[] }) {
  return (
    <>
      {settings.map((setting) => (
        <SettingField key={setting.key} setting={setting} values={values} change={change} />
      ))}
    </>
  );
}

function SettingField({ setting, values, change }: SettingsProps & { setting: Setting }) {
  const { key, label, help } = setting;
  switch (setting.kind) {
    case "number":
      return (
        <Slider
          {...setting}
          label={label}
          help={`${help} Default: ${usualOf(values, setting)}.`}
          value={numberOf(values, setting)}
          step={setting.integer === true ? 1 : Math.max(1e-6, setting.defaultValue / 20)}
          onChange={(value) => change({ [key]: admissible(setting, value) })}
        />
      );
    case "choice":
      return (
        <Select
          label={label}
          help={help}
          choices={setting.choices}
          value={choiceOf(values, setting)}
          onChange={(value) => change({ [key]: settingOf(value) })}
        />
      );
    case "switch":
      return (
        <Toggle
          label={label}
          help={help}
          value={switchOf(values, setting)}
          onChange={(value) => change({ [key]: value })}
        />
      );
  }
}

interface Anchor {
  select: unknown;
  weight?: number;
}

/** Groups that are softly attracted to their positions, in contrast to a fixed part. */
function Anchors({ page }: { page: Page }) {
  const { editor } = page;
  const state = editor.state.value;
  const groups = groupsOf(state).map(({ name }) => name);
  const found = (state?.steps.at(-1)?.fields as { anchors?: unknown } | undefined)?.anchors;
  if (found !== undefined && !Array.isArray(found))
    return <p class="hint">The anchors of this step cannot be changed here. They are kept.</p>;
  const anchors: Anchor[] = Array.isArray(found) ? (found as Anchor[]) : [];
  const isAnchored = (name: string) => anchors.some(({ select }) => select === name);
  const ask = (next: Anchor[]) =>
    void editor.ask({ do: "settings", anchors: next.map(({ select, weight = 10 }) => ({ select, weight })) });
  return (
    <fieldset>
      <legend>Anchors</legend>
      <p class="hint">
        {groups.length === 0
          ? "Save a selection as a group, to anchor it: it then resists moving, but gives way more than a fixed area."
          : "An anchored group resists moving, but gives way more than a fixed area."}
      </p>
      {groups.map((name) => (
        <Toggle
          key={name}
          label={name}
          value={isAnchored(name)}
          onChange={(on) =>
            ask(
              on
                ? [...anchors, { select: name, weight: 10 }]
                : anchors.filter(({ select }) => select !== name),
            )
          }
        />
      ))}
      {anchors.map((anchor, i) => (
        <Slider
          key={i}
          label={typeof anchor.select === "string" ? `Weight of ${anchor.select}` : `Weight ${i + 1}`}
          value={anchor.weight ?? 10}
          min={0}
          max={1e6}
          softMax={1000}
          logarithmic
          help="How strongly the anchor resists moving."
          onChange={(weight) => ask(anchors.map((other, k) => (k === i ? { ...other, weight } : other)))}
        />
      ))}
    </fieldset>
  );
}

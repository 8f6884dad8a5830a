import { useEffect, useId, useRef, useState } from "preact/hooks";
import type { ComponentChildren } from "preact";
import { formatNumber, parseQuantity, type Quantity, type Unit } from "../../app/units";

interface NumberFieldProps {
  label: string;
  value: number;
  /** A number stays shown until a promise that is returned settles. */
  onChange: (value: number) => unknown;
  quantity?: Quantity;
  unit?: Unit;
  /** Shown after the number. */
  suffix?: string;
  step?: number;
  min?: number;
  max?: number;
  /** Exclusive lower bound. */
  above?: number;
  integer?: boolean;
  disabled?: boolean;
  digits?: number;
  /** Largest number of decimals shown. */
  decimals?: number;
  labelledBy?: string;
  tip?: string;
}

/**
 * A number field that accepts units and small calculations. The up and down keys change the number by a step (shift:
 * ten steps, alt: a tenth).
 */
export function NumberField(props: NumberFieldProps) {
  const { label, value, onChange, quantity = "number", unit = "none", suffix, step = 1, disabled } = props;
  const [typed, setTyped] = useState<string | null>(null);
  const [given, setGiven] = useState<number | null>(null); // while the change that it asks for goes on
  const saysId = useId();
  const shown = formatNumber(given ?? value, props.digits, props.decimals);
  const parsed = typed === null ? value : parseQuantity(typed, quantity, unit);
  const bad = parsed === undefined || (typed !== null && !isInRange(parsed, props));
  const [told, setTold] = useState<string | null>(null); // the sentence on a refused input
  const [hasFocus, setHasFocus] = useState(false);
  useEffect(() => {
    // The sentence stays until the input changes, or for a while where a refused input was left.
    if (told === null || hasFocus) return undefined;
    const timer = setTimeout(() => setTold(null), messageMs);
    return () => clearTimeout(timer);
  }, [told, hasFocus]);
  const give = (number: number) => {
    const change = onChange(number);
    if (!(change instanceof Promise)) return;
    setGiven(number);
    void change.finally(() => setGiven(null));
  };
  /** Commits the typed text. Returns whether it is valid. */
  const confirm = (): boolean => {
    if (bad) setTold(parsed === undefined ? writingWords(quantity, unit, props) : `Enter ${rangeWords(props)}.`);
    else if (typed !== null && typed.trim() !== shown) give(parsed);
    if (!bad) setTyped(null);
    return !bad;
  };
  const onFocus = (event: FocusEvent) => {
    setHasFocus(true);
    if (event.currentTarget instanceof HTMLInputElement) event.currentTarget.select();
  };
  const onBlur = () => {
    setHasFocus(false);
    if (told === null) confirm();
    else setTold(null);
    setTyped(null);
  };
  const leave = (event: KeyboardEvent) => {
    event.stopPropagation();
    if (typed === null && event.target instanceof HTMLElement) event.target.blur();
    setTyped(null);
    setTold(null);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    if (event.key === "Enter" && !confirm()) event.preventDefault();
    if (event.key === "Escape") leave(event);
    if (event.key !== "ArrowUp" && event.key !== "ArrowDown") return;
    event.preventDefault();
    const by = (event.key === "ArrowUp" ? 1 : -1) * step * (event.shiftKey ? 10 : event.altKey ? 0.1 : 1);
    const next = Number(inForm((parsed ?? value) + by, props).toPrecision(12));
    setTyped(null);
    const kept = Math.min(props.max ?? Infinity, Math.max(props.min ?? -Infinity, next));
    setTold(isInRange(next, props) ? null : `Enter ${rangeWords(props)}.`);
    if (isInRange(kept, props) && kept !== value) onChange(kept);
  };
  return (
    <>
    <span class={`number ${bad ? "bad" : ""} ${disabled === true ? "disabled" : ""}`} data-tip={props.tip}>
      <input
        type="text"
        inputMode="decimal"
        spellcheck={false}
        autocomplete="off"
        aria-label={props.labelledBy === undefined ? label : undefined}
        aria-labelledby={props.labelledBy}
        aria-invalid={bad}
        aria-describedby={told !== null ? saysId : undefined}
        disabled={disabled}
        data-confirmed={typed === null ? "" : undefined}
        value={typed ?? shown}
        onFocus={onFocus}
        onInput={(event) => {
          setTyped(event.currentTarget.value);
          setTold(null);
        }}
        onKeyDown={onKeyDown}
        onBlur={onBlur}
      />
      {suffix !== undefined && suffix !== "" && <span class="suffix">{suffix}</span>}
    </span>
    {told !== null && (
      <span class="number-says" role="alert" id={saysId}>
        {told}
      </span>
    )}
    </>
  );
}

const messageMs = 4000;

type Range = Pick<NumberFieldProps, "min" | "max" | "above" | "integer">;

function inForm(value: number, { integer }: Range): number {
  return integer === true ? Math.round(value) : value;
}

/** Returns whether a number is within a range, and whole where it has to be. */
export function isInRange(value: number, { min = -Infinity, max = Infinity, above = -Infinity, integer }: Range): boolean {
  return value >= min && value <= max && (value > above || above === -Infinity) && (integer !== true || Number.isInteger(value));
}

/** Returns examples of how a quantity can be written, or its range. */
function writingWords(quantity: Quantity, unit: Unit, range: Range): string {
  const isBounded = range.min !== undefined || range.max !== undefined || range.above !== undefined;
  if (quantity === "number" && isBounded) return `Enter ${rangeWords(range)}.`;
  if (quantity === "angle") return "Enter an angle, such as 45 or 2 turns.";
  if (quantity === "length") return unit === "none" ? "Enter a length, such as 12.5." : "Enter a length, such as 12.5 or 3 mm.";
  return quantity === "factor" ? "Enter a factor, such as 1.5 or 150 %." : "Enter a number, such as 12.5.";
}

/** Describes the numbers of a range: "a number from 1 to 20". */
export function rangeWords({ min = -Infinity, max = Infinity, above, integer }: Range): string {
  const number = (value: number) => formatNumber(value);
  const kind = integer === true ? "a whole number" : "a number";
  if (above !== undefined) return `${kind} above ${number(above)}${max < Infinity ? `, up to ${number(max)}` : ""}`;
  if (min > -Infinity && max < Infinity) return `${kind} from ${number(min)} to ${number(max)}`;
  if (min > -Infinity) return `${kind} of at least ${number(min)}`;
  return max < Infinity ? `${kind} of at most ${number(max)}` : kind;
}

interface SliderProps extends Omit<NumberFieldProps, "min" | "max"> {
  min: number;
  max: number;
  /** The ends of the track, if numbers beyond can be typed. */
  softMin?: number;
  softMax?: number;
  /** Whether steps grow with the value. 0 stays reachable. */
  logarithmic?: boolean;
  /** The change by an arrow key on the track. Absent: the smallest change that the track can show. */
  arrowStep?: number;
  help?: string;
  /** Called while the slider is dragged; `onChange` is called at the end. */
  onInput?: (value: number) => void;
  children?: ComponentChildren;
}

/** The range of an angle in degrees: the track and the field go to half a turn in either direction. */
export const degrees = { min: -180, max: 180, suffix: "°", arrowStep: 1 } as const;

const positions = 1000;
const pauseMs = 300; // arrow-key presses that follow within this time are one change
const arrowKeys: Readonly<Record<string, number>> = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };

/** A named slider with a number field. */
export function Slider(props: SliderProps) {
  const id = useId();
  const [dragged, setDragged] = useState<number | null>(null);
  const low = props.softMin ?? props.min;
  const high = props.softMax ?? props.max;
  const track = new Track(low, high, props.logarithmic === true);
  const value = dragged ?? props.value;
  const take = (position: number): number => {
    const raw = track.value(position / positions);
    return props.integer === true ? Math.round(raw) : Number(raw.toPrecision(3));
  };
  const ending = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  const end = () => {
    clearTimeout(ending.current);
    if (dragged !== null && dragged !== props.value) props.onChange(dragged);
    setDragged(null);
  };
  const move = (next: number) => {
    setDragged(next);
    props.onInput?.(next);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const by = arrowKeys[event.key];
    if (by === undefined || props.arrowStep === undefined) return;
    event.preventDefault();
    clearTimeout(ending.current);
    const next = Math.round(value / props.arrowStep + by) * props.arrowStep;
    move(Number(Math.min(high, Math.max(low, next)).toPrecision(12)));
  };
  return (
    <div class={`row slider ${props.disabled === true ? "disabled" : ""}`} data-tip={props.help}>
      <label id={id}>{props.label}</label>
      <input
        type="range"
        min={0}
        max={positions}
        step={props.integer === true && !track.logarithmic ? positions / Math.max(1, high - low) : 1}
        aria-labelledby={id}
        aria-valuetext={formatNumber(value)}
        disabled={props.disabled}
        value={Math.round(positions * track.position(value))}
        style={{ "--at": `${100 * track.position(value)}%` }}
        onInput={(event) => move(take(Number(event.currentTarget.value)))}
        onKeyDown={onKeyDown}
        onKeyUp={(event) => {
          if (arrowKeys[event.key] !== undefined) ending.current = setTimeout(end, pauseMs);
        }}
        onBlur={end}
        onChange={end}
      />
      <NumberField {...props} value={value} labelledBy={id} tip={undefined} />
    </div>
  );
}

/** Maps numbers to positions on a slider (0 to 1) and back. */
export class Track {
  private readonly floor: number;

  constructor(
    readonly low: number,
    readonly high: number,
    readonly logarithmic: boolean,
  ) {
    this.floor = low > 0 ? low : high / 1e4;
  }

  value(position: number): number {
    if (!this.logarithmic) return this.low + position * (this.high - this.low);
    if (position <= 0) return this.low;
    return this.floor * (this.high / this.floor) ** position;
  }
  position(value: number): number {
    const raw = this.logarithmic
      ? value <= this.floor
        ? 0
        : Math.log(value / this.floor) / Math.log(this.high / this.floor)
      : (value - this.low) / (this.high - this.low);
    return Math.min(1, Math.max(0, raw));
  }
}

interface ToggleProps {
  label: string;
  value: boolean;
  onChange: (value: boolean) => void;
  help?: string;
  keys?: string;
  disabled?: boolean;
}

export function Toggle({ label, value, onChange, help, keys, disabled }: ToggleProps) {
  return (
    <label class={`row toggle ${disabled === true ? "disabled" : ""}`} data-tip={help} data-keys={keys}>
      <span>{label}</span>
      <input
        type="checkbox"
        role="switch"
        checked={value}
        disabled={disabled}
        onChange={(event) => onChange(event.currentTarget.checked)}
      />
    </label>
  );
}

export interface Choice<Value extends string> {
  value: Value;
  label: string;
  help?: string;
}

interface SelectProps<Value extends string> {
  label: string;
  value: Value;
  choices: readonly Choice<Value>[];
  onChange: (value: Value) => void;
  help?: string;
  disabled?: boolean;
}

export function Select<Value extends string>(props: SelectProps<Value>) {
  const id = useId();
  return (
    <div class="row" data-tip={props.help}>
      <label for={id}>{props.label}</label>
      <select
        id={id}
        value={props.value}
        disabled={props.disabled}
        onChange={(event) => {
          const chosen = props.choices.find((choice) => choice.value === event.currentTarget.value);
          if (chosen !== undefined) props.onChange(chosen.value);
        }}
      >
        {props.choices.map((choice) => (
          <option key={choice.value} value={choice.value}>
            {choice.label}
          </option>
        ))}
      </select>
    </div>
  );
}

/** A few choices side by side. Arrow keys move between them. */
export function Segments<Value extends string>(props: SelectProps<Value> & { hideLabel?: boolean; inPairs?: boolean }) {
  const id = useId();
  return (
    <div
      class={`row segments ${props.hideLabel === true ? "wide" : ""} ${props.inPairs === true ? "in-pairs" : ""}`}
      data-tip={props.help}
    >
      <span id={id} class={props.hideLabel === true ? "hidden" : "label"}>
        {props.label}
      </span>
      <div role="radiogroup" aria-labelledby={id}>
        {props.choices.map((choice) => (
          <label
            key={choice.value}
            data-tip={choice.help}
            class={choice.value === props.value ? "chosen" : ""}
          >
            <input
              type="radio"
              name={id}
              checked={choice.value === props.value}
              disabled={props.disabled}
              onChange={() => props.onChange(choice.value)}
            />
            {choice.label}
          </label>
        ))}
      </div>
    </div>
  );
}

/** A name that is edited in place: enter confirms, escape reverts. */
export function NameField({
  name,
  onRename,
  onEnd,
}: {
  name: string;
  onRename: (to: string) => void;
  onEnd: () => void;
}) {
  const ended = useRef(false);
  const end = (to: string | null) => {
    if (ended.current) return;
    ended.current = true;
    if (to !== null && to !== "" && to !== name) onRename(to);
    onEnd();
  };
  return (
    <input
      class="name-field"
      type="text"
      aria-label={`New name of ${name}`}
      autoFocus
      defaultValue={name}
      onFocus={(event) => event.currentTarget.select()}
      onClick={(event) => event.stopPropagation()}
      onKeyDown={(event) => {
        event.stopPropagation();
        if (event.key === "Enter") end(event.currentTarget.value.trim());
        if (event.key === "Escape") end(null);
      }}
      onBlur={(event) => end(event.currentTarget.value.trim())}
    />
  );
}
